//! `pixel`: how fast one pixel converges.

use super::{Outcome, study};
use crate::cli::{Common, PixelArgs, StudiedChannel, TracerChoice};
use crate::plan;
use anyhow::{Result, ensure};
use serde::Serialize;
use stratcore::trace::{TracedScene, Tracer};

#[derive(Serialize)]
struct Subject<'a> {
    scene: &'a str,
    channel: &'a str,
}

pub fn run(args: &PixelArgs, common: &Common) -> Result<Outcome> {
    let pixel = plan::pixel(&args.at)?;
    let scene = super::load(&args.scene, common)?;
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
    let channel = plan::channel(args.channel);
    let channel_name = match args.channel {
        StudiedChannel::Luminance => "luminance",
        StudiedChannel::R => "r",
        StudiedChannel::G => "g",
        StudiedChannel::B => "b",
    };
    let name = scene.name.clone();
    let tracer = match args.tracer {
        TracerChoice::Beam => Tracer::Beam,
        TracerChoice::Bvh => Tracer::Bvh,
    };
    let traced = TracedScene::new(scene).with_tracer(tracer);
    let title = format!("{name}, pixel {},{}, {channel_name}", pixel[0], pixel[1]);
    let subject = Subject { scene: &name, channel: channel_name };
    study::run(subject, &title, &traced.pixel(pixel, channel), pixel, &args.study, common)
}
