//! The integrands that can be called by name.
//!
//! Adding one is one file with an [`IntegrandInfo`] and one line in [`CATALOGUE`].

use super::{
    Integrand, checkerboard, disk, disks, form_factor, half_space, koch, linear, perpendicular,
    product, rough_edge, step,
};

/// Every closed-form integrand, in the order in which they are listed.
pub const CATALOGUE: &[IntegrandInfo] = &[
    linear::CONSTANT,
    linear::RAMP,
    step::STEP,
    half_space::HALF_SPACE,
    disk::DISK,
    product::GAUSSIAN,
    product::COSINES,
    product::MULTILINEAR,
    checkerboard::CHECKERBOARD,
    koch::KOCH,
    rough_edge::ROUGH_EDGE,
    form_factor::FORM_FACTOR,
    perpendicular::PERPENDICULAR,
    disks::DISKS,
];

/// Most dimensions of an integrand that is defined in any number of them.
pub(super) const MAX_DIM: usize = 64;

/// What a caller may ask for.
#[derive(Debug, Clone, Copy)]
pub struct IntegrandInfo {
    /// As typed on the command line and printed in reports.
    pub name: &'static str,
    /// One line of help.
    pub summary: &'static str,
    /// Its parameters.
    pub params: &'static [ParamInfo],
    /// Fewest dimensions.
    pub min_dim: usize,
    /// Most dimensions.
    pub max_dim: usize,
    /// Builds it from a dimension and one value per parameter, all in range.
    pub(super) build: fn(usize, &[f64]) -> Box<dyn Integrand>,
}

impl IntegrandInfo {
    /// The dimension used where none is asked for: 2, or the nearest that it has.
    pub fn default_dim(&self) -> usize {
        2.clamp(self.min_dim, self.max_dim)
    }
}

/// One number that shapes an integrand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParamInfo {
    /// As typed.
    pub name: &'static str,
    /// Value used where none is given.
    pub default: f64,
    /// What it means, with its unit.
    pub meaning: &'static str,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
}

/// An integrand that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntegrandError {
    /// A name that is not in the catalogue.
    #[error("no integrand is called \"{name}\"; there are {known}")]
    UnknownName {
        /// The name as typed.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A parameter that the integrand does not have.
    #[error("{integrand} has no parameter \"{param}\"; {known}")]
    UnknownParam {
        /// Integrand's name.
        integrand: &'static str,
        /// The parameter as typed.
        param: String,
        /// Words naming those that it has.
        known: String,
    },
    /// A parameter given more than once.
    #[error("{integrand}: {param} is given twice; keep one")]
    RepeatedParam {
        /// Integrand's name.
        integrand: &'static str,
        /// The parameter.
        param: &'static str,
    },
    /// A value outside its parameter's range, or not a number.
    #[error("{integrand}: {param} = {value} is out of range; it takes {min} to {max}")]
    OutOfRange {
        /// Integrand's name.
        integrand: &'static str,
        /// The parameter.
        param: &'static str,
        /// The value asked for.
        value: f64,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// A dimension in which the integrand is not defined.
    #[error("{integrand} has no form in d = {dim}; it is defined for {dims}")]
    DimNotSupported {
        /// Integrand's name.
        integrand: &'static str,
        /// Dimension asked for.
        dim: usize,
        /// Words naming the dimensions that it has.
        dims: String,
    },
}

/// The integrand of this name, in `dim` dimensions or its
/// [`default_dim`](IntegrandInfo::default_dim), with the parameters given and the others at
/// their defaults.
///
/// # Errors
/// [`IntegrandError`] names the fault and what is allowed.
pub fn by_name(
    name: &str,
    dim: Option<usize>,
    params: &[(String, f64)],
) -> Result<Box<dyn Integrand>, IntegrandError> {
    let info = CATALOGUE.iter().find(|info| info.name == name).ok_or_else(|| {
        let known = listed(CATALOGUE.iter().map(|info| info.name));
        IntegrandError::UnknownName { name: name.to_owned(), known }
    })?;
    let integrand = info.name;
    let dim = dim.unwrap_or_else(|| info.default_dim());
    if !(info.min_dim..=info.max_dim).contains(&dim) {
        let dims = if info.min_dim == info.max_dim {
            format!("d = {}", info.min_dim)
        } else {
            format!("d = {} to {}", info.min_dim, info.max_dim)
        };
        return Err(IntegrandError::DimNotSupported { integrand, dim, dims });
    }
    let mut values: Vec<Option<f64>> = vec![None; info.params.len()];
    for (typed, value) in params {
        let Some(i) = info.params.iter().position(|param| param.name == typed) else {
            let known = if info.params.is_empty() {
                "it takes none".to_owned()
            } else {
                format!("it takes {}", listed(info.params.iter().map(|param| param.name)))
            };
            let param = typed.clone();
            return Err(IntegrandError::UnknownParam { integrand, param, known });
        };
        let ParamInfo { name: param, min, max, .. } = info.params[i];
        if !(min..=max).contains(value) {
            return Err(IntegrandError::OutOfRange { integrand, param, value: *value, min, max });
        }
        if values[i].replace(*value).is_some() {
            return Err(IntegrandError::RepeatedParam { integrand, param });
        }
    }
    let values: Vec<f64> = values
        .iter()
        .zip(info.params)
        .map(|(value, param)| value.unwrap_or(param.default))
        .collect();
    Ok((info.build)(dim, &values))
}

fn listed(names: impl Iterator<Item = &'static str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::Regularity;
    use std::collections::HashSet;

    fn message(name: &str, dim: Option<usize>, params: &[(&str, f64)]) -> String {
        let params: Vec<_> = params.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
        by_name(name, dim, &params).err().map(|e| e.to_string()).unwrap_or_default()
    }

    #[test]
    fn the_catalogue_is_consistent() {
        let names: HashSet<_> = CATALOGUE.iter().map(|info| info.name).collect();
        assert_eq!(names.len(), CATALOGUE.len());
        for info in CATALOGUE {
            assert!(!info.summary.is_empty() && info.min_dim >= 1 && info.min_dim <= info.max_dim);
            for param in info.params {
                assert!((param.min..=param.max).contains(&param.default), "{}", param.name);
            }
            for dim in [info.min_dim, info.default_dim(), info.max_dim] {
                let integrand = by_name(info.name, Some(dim), &[]).unwrap();
                assert_eq!((integrand.dim(), integrand.axes().len()), (dim, dim));
                assert!(integrand.reference().is_some());
                assert!(integrand.exact_variance("random", 1).is_some(), "{}", info.name);
                assert_ne!(integrand.regularity(), Regularity::Unknown);
                let corners = [vec![0.0; dim], vec![1.0 - f64::EPSILON; dim]];
                assert!(corners.iter().all(|x| integrand.eval(x).is_finite()));
            }
        }
    }

    /// Every parameter at both ends of its range: finite values, a mean, a variance that is
    /// neither negative nor missing.
    #[test]
    fn the_ends_of_every_range_are_sound() {
        for info in CATALOGUE {
            for param in info.params {
                for value in [param.min, param.max] {
                    let integrand =
                        by_name(info.name, None, &[(param.name.to_owned(), value)]).unwrap();
                    let mean = integrand.reference().unwrap().mean;
                    assert!(mean.is_finite(), "{} {} = {value}: {mean}", info.name, param.name);
                    let variance = integrand.exact_variance("random", 1).unwrap();
                    let case = format!("{} {} = {value}: {mean} {variance}", info.name, param.name);
                    assert!(variance.is_finite() && variance >= 0.0, "{case}");
                    let constant = integrand.regularity() == Regularity::Constant;
                    assert_eq!(constant, variance == 0.0, "{case}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_made_is_refused_in_words() {
        assert!(message("cone", None, &[]).contains("half-space, disk"));
        assert!(message("disk", None, &[("size", 1.0)]).ends_with("it takes radius"));
        assert!(message("koch", Some(3), &[]).ends_with("defined for d = 2"));
        assert!(message("form-factor", Some(2), &[]).ends_with("d = 4"));
        assert!(message("ramp", Some(0), &[]).contains("d = 1 to 64"));
        assert!(message("disk", None, &[("radius", 0.9)]).contains("0.001 to 0.45"));
        assert!(message("disk", None, &[("radius", f64::NAN)]).contains("NaN is out of range"));
        assert!(message("step", None, &[("edge", 0.1), ("edge", 0.2)]).contains("given twice"));
    }
}
