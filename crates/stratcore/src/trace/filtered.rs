//! A pixel under a reconstruction filter.

use super::rays::Radiance;
use crate::integrand::Integrand;
use crate::scene::{Filter, FilterMethod, Rgb};

/// The weighted mean over a filter's support. The first two coordinates of a point are the
/// support's, or for filter importance sampling the shares of weight on either side.
pub struct Filtered<'a, I: ?Sized> {
    filter: &'a Filter,
    /// What the unit square of the whole support sees.
    inner: Box<I>,
}

impl<'a, I: ?Sized> Filtered<'a, I> {
    pub(super) fn new(inner: Box<I>, filter: &'a Filter) -> Self {
        Self { filter, inner }
    }

    /// What is weighed.
    pub(super) fn inner(&self) -> &I {
        &self.inner
    }

    /// Moves a point to where it is evaluated; its value there counts this many times.
    fn place(&self, point: &mut [f64]) -> f64 {
        let [u, v] = [point[0], point[1]];
        match self.filter.method {
            FilterMethod::WeightedMean => self.filter.weight(u, v),
            FilterMethod::WeightedSum => self.filter.weight(u, v) / self.filter.mean_weight(),
            FilterMethod::Importance => {
                let (at, gain) = self.filter.place(u, v);
                point[..2].copy_from_slice(&at);
                gain
            }
        }
    }
}

impl<I: Integrand + ?Sized> Integrand for Filtered<'_, I> {
    fn dim(&self) -> usize {
        self.inner.dim()
    }

    fn axes(&self) -> Vec<String> {
        self.inner.axes()
    }

    fn eval(&self, point: &[f64]) -> f64 {
        let mut value = [0.0];
        self.eval_block(point, &mut value);
        value[0]
    }

    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        let mut placed = points.to_vec();
        let gains: Vec<f64> =
            placed.chunks_exact_mut(self.dim()).map(|point| self.place(point)).collect();
        self.inner.eval_block(&placed, values);
        for (value, gain) in values.iter_mut().zip(gains) {
            *value *= gain;
        }
    }

    fn is_weighted(&self) -> bool {
        self.filter.method == FilterMethod::WeightedMean
    }

    fn weigh_block(&self, points: &[f64], weights: &mut [f64]) {
        for (point, weight) in points.chunks_exact(self.dim()).zip(weights) {
            *weight = self.filter.weight(point[0], point[1]);
        }
    }
}

impl<I: Radiance + ?Sized> Radiance for Filtered<'_, I> {
    fn radiance(&self, point: &[f64]) -> Rgb {
        let mut point = point.to_vec();
        let gain = self.place(&mut point);
        self.inner.radiance(&point).map(|channel| channel * gain)
    }
}
