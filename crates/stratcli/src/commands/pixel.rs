//! `pixel`: how fast one pixel converges.

use super::{Outcome, measure};
use crate::cli::{Common, PixelArgs};
use crate::plan;
use anyhow::{Result, ensure};
use serde::Serialize;
use stratcore::StudyError;
use stratcore::dimensions::predict_pixel;
use stratcore::exact::TOLERANCE;
use stratcore::integrand::Integrand;
use stratcore::scene::Scene;
use stratcore::study::{Control, ExactStudy};
use stratcore::trace::TracedScene;

#[derive(Serialize)]
struct Subject<'a> {
    scene: &'a str,
    channel: &'a str,
}

pub fn run(args: &PixelArgs, common: &Common) -> Result<Outcome> {
    let scene = super::load(&args.scene, common)?;
    let pixel = pixel_of(&scene, &args.at)?;
    let (channel, channel_name) = plan::channel(args.channel);
    let name = scene.name.clone();
    let traced = TracedScene::new(scene).with_tracer(plan::tracer(args.tracer));
    let title = format!("{name}, pixel {},{}, {channel_name}", pixel[0], pixel[1]);
    let subject = Subject { scene: &name, channel: channel_name };
    let integrand = traced.pixel(pixel, channel);
    let by = |plan: &_, until, control: Control<'_>| {
        let (mut result, stop) = match args.exact {
            true => (ExactStudy::new(plan, TOLERANCE)?.pixel(&integrand, pixel, control)?, None),
            false => measure::by_trials(&integrand, pixel, plan, until, control)?,
        };
        match predict_pixel(&mut result, &integrand, control) {
            // What was finished is kept.
            Ok(()) | Err(StudyError::Cancelled) => Ok((result, stop)),
            Err(error) => Err(error),
        }
    };
    measure::run(subject, &title, integrand.dim(), &by, &args.study, common)
}

/// The pixel as typed, if the picture has it.
pub fn pixel_of(scene: &Scene, at: &str) -> Result<[u32; 2]> {
    let pixel = plan::pixel(at)?;
    let [width, height] = scene.camera.resolution;
    ensure!(
        pixel[0] < width && pixel[1] < height,
        "--at {},{}: outside the picture of {}, which is {width} × {height}; \
         X runs from 0 to {} and Y from 0 to {}",
        pixel[0],
        pixel[1],
        scene.name,
        width - 1,
        height - 1,
    );
    Ok(pixel)
}
