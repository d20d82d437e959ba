//! What a pixel's axes predict, against its exact curve.

use stratcore::dimensions::predict_pixel;
use stratcore::exact::TOLERANCE;
use stratcore::scene::{Channel, load};
use stratcore::study::{Control, ExactStudy, SamplerChoice, StudyPlan};
use stratcore::trace::TracedScene;

#[test]
fn pixels_converge_as_their_axes_predict() {
    for name in ["classic", "classic-shadows", "edges", "grass", "room-point"] {
        let scene = TracedScene::new(load(name).unwrap());
        let plan = StudyPlan {
            samplers: vec![SamplerChoice::JITTERED],
            counts: vec![32u64.pow(2), 64u64.pow(2), 128u64.pow(2)],
            ..StudyPlan::paper()
        };
        let exact = ExactStudy::new(&plan, TOLERANCE).unwrap();
        let (mut all, mut open, mut lines) = (0, 0, Vec::new());
        for pixel in (8..256).step_by(16).flat_map(|x| (8..256).step_by(16).map(move |y| [x, y])) {
            let integrand = scene.pixel(pixel, Channel::Luminance);
            let mut result = exact.pixel(&integrand, pixel, Control::unwatched()).unwrap();
            if result.samplers[0].unresolved.is_some() || result.samplers[0].exact {
                continue;
            }
            predict_pixel(&mut result, &integrand, Control::unwatched()).unwrap();
            let sampler = &result.samplers[0];
            all += 1;
            let Some(predicted) = sampler.predicted else {
                open += 1;
                continue;
            };
            let p = sampler.fit.unwrap().exponent;
            lines.push((predicted, p, pixel));
        }
        for predicted in [1.0, 1.5, 2.0] {
            let mut found: Vec<_> = lines.iter().filter(|l| l.0 == predicted).collect();
            found.sort_by(|a, b| a.1.total_cmp(&b.1));
            let worst: Vec<_> = found
                .iter()
                .rev()
                .take(6)
                .chain(found.iter().take(6))
                .map(|l| (l.1, l.2))
                .collect();
            eprintln!("{name}: {all} ({open} open), {predicted}: {} {worst:?}", found.len());
        }
    }
}
