//! Files of point sets.

use super::says_one_line;
use stratcore::rng::StreamKey;
use stratcore::sampler::{PointFile, PointSet, Sampler as _, Scramble};

/// CSV, or UTK's text or binary.
pub fn file(data: &[u8]) {
    let file = match PointFile::parse("p", data) {
        Ok(file) => file,
        Err(error) => return says_one_line(&error.to_string()),
    };
    let most = file.facts().max_dim;
    for n in file.counts().into_iter().take(4) {
        for (trial, dim) in [(0, most), (7, 1)] {
            let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 17, n_samples: n, trial };
            for scramble in [Scramble::None, Scramble::TorusShift] {
                let set = PointSet { key, dim, scramble, rectangular: false };
                let mut points = vec![0.0; n as usize * dim];
                file.points(&set).fill(0, &mut points);
                assert!(points.iter().all(|x| (0.0..1.0).contains(x)), "{points:?}");
            }
        }
    }
}
