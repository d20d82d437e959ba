//! Lists of sample counts as people write them.

/// A list of sample counts that could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CountsError {
    /// Not one of the forms.
    #[error(
        "cannot read \"{0}\" as sample counts; write 1..16^2 (1, 4, 9, …, 256), 2^0..2^12, \
         or a list such as 1,4,16"
    )]
    Unreadable(String),
    /// A count of zero, or more counts or points than can be meant.
    #[error("\"{0}\" asks for {1}; counts run from 1 to 2^43, at most 1000 of them")]
    OutOfRange(String, &'static str),
}

/// Reads `1..16^2` (k^2 for k = 1…16), `2^0..2^12` (powers of one base), or `1,4,9`. The order
/// is kept; a count that stands twice is an error.
///
/// # Errors
/// [`CountsError`] quotes the part that could not be read.
pub fn parse_counts(text: &str) -> Result<Vec<u64>, CountsError> {
    const MOST: usize = 1000;
    const LARGEST: u64 = 1 << 43;
    let out_of_range = |what| CountsError::OutOfRange(text.to_owned(), what);
    let unreadable = || CountsError::Unreadable(text.to_owned());
    let number = |s: &str| s.trim().parse::<u64>().map_err(|_| unreadable());
    let power = |base: u64, exponent: u64| {
        u32::try_from(exponent)
            .ok()
            .and_then(|e| base.checked_pow(e))
            .ok_or_else(|| out_of_range("a count beyond 64 bits"))
    };
    let counts: Vec<u64> = if let Some((from, to)) = text.split_once("..") {
        let (last, exponent) = to.split_once('^').ok_or_else(unreadable)?;
        // Each term is a number, of which either the base or the exponent runs from lo to hi.
        let (lo, hi, fixed_base) = if let Some((base, first)) = from.split_once('^') {
            if number(last)? != number(base)? {
                return Err(unreadable());
            }
            (number(first)?, number(exponent)?, true)
        } else {
            (number(from)?, number(last)?, false)
        };
        let fixed = number(if fixed_base { last } else { exponent })?;
        if lo > hi {
            return Err(out_of_range("a range that ends before it starts"));
        }
        if hi - lo >= MOST as u64 {
            return Err(out_of_range("too many counts"));
        }
        let term = |k| if fixed_base { power(fixed, k) } else { power(k, fixed) };
        (lo..=hi).map(term).collect::<Result<_, _>>()?
    } else {
        text.split(',').map(number).collect::<Result<_, _>>()?
    };
    if counts.len() > MOST {
        return Err(out_of_range("too many counts"));
    }
    if counts.contains(&0) {
        return Err(out_of_range("a count of 0"));
    }
    if counts.iter().any(|n| *n > LARGEST) {
        return Err(out_of_range("a count beyond 2^43"));
    }
    let mut sorted = counts.clone();
    sorted.sort_unstable();
    if sorted.windows(2).any(|w| w[0] == w[1]) {
        return Err(out_of_range("the same count twice"));
    }
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        assert_eq!(parse_counts("1..4^2").unwrap(), [1, 4, 9, 16]);
        assert_eq!(parse_counts("2..3^4").unwrap(), [16, 81]);
        assert_eq!(parse_counts("2^0..2^3").unwrap(), [1, 2, 4, 8]);
        assert_eq!(parse_counts("1, 4,9").unwrap(), [1, 4, 9]);
        assert_eq!(parse_counts("7").unwrap(), [7]);
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        for text in [
            "",
            "x",
            "1..16",
            "1..x^2",
            "2^0..3^4",
            "4..1^2",
            "0",
            "1,1",
            "1..2000^2",
            "-1",
            "2^0..2^80",
            "99999999999999999999",
            "1..3^99999999999",
            "1,,2",
            "..",
            "^..^",
            "0..4^2",
            "1^0..1^3",
            "17592186044416",
        ] {
            let error = parse_counts(text).unwrap_err().to_string();
            assert!(error.contains(&format!("\"{text}\"")), "{error}");
        }
    }
}
