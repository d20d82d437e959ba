//! `stratviz`: opens the explorer, with the last session or with what is named on the command
//! line.

use clap::Parser;
use eframe::egui::{ViewportBuilder, vec2};
use std::path::PathBuf;
use std::sync::Arc;
use stratviz::app::App;
use stratviz::state::State;

/// Click a pixel and watch its variance curve form.
#[derive(Debug, Parser)]
#[command(name = "stratviz", version)]
struct Options {
    /// A scene file, an .obj, or a built-in scene [default: that of the last session]
    scene: Option<String>,
    /// Where the session is kept [default: in the user's data folder]
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
}

fn main() -> eframe::Result {
    let options = Options::parse();
    let native = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("stratviz")
            .with_app_id("stratviz")
            .with_inner_size(vec2(1280.0, 720.0))
            .with_min_inner_size(vec2(800.0, 500.0)),
        persistence_path: options.session,
        ..Default::default()
    };
    let scene = options.scene;
    eframe::run_native(
        "stratviz",
        native,
        Box::new(|creation| {
            let saved = creation.storage.and_then(|s| eframe::get_value(s, eframe::APP_KEY));
            let mut state: State = saved.unwrap_or_default();
            if let Some(scene) = scene
                && scene != state.scene
            {
                (state.scene, state.pixels) = (scene, Vec::new());
            }
            let ctx = creation.egui_ctx.clone();
            Ok(Box::new(App::new(state, Arc::new(move || ctx.request_repaint()))))
        }),
    )
}
