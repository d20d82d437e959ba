//! A hash that tells two plans, two scenes or two stored tiles apart.

/// FNV-1a with 128 bits of state (Fowler, Noll & Vo), taking words of 64 bits. It guards against
/// mistakes and damage, not against malice. Bytes given one at a time have the published hash.
#[derive(Debug, Clone, Copy)]
pub struct Digest(u128);

impl Digest {
    const OFFSET_BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = (1 << 88) + 0x13b;

    /// The hash of nothing.
    pub fn new() -> Self {
        Self(Self::OFFSET_BASIS)
    }

    /// Adds one word.
    pub fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ u128::from(word)).wrapping_mul(Self::PRIME);
    }

    /// Adds numbers by their bits.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|x| self.word(x.to_bits()));
    }

    /// Adds the bytes of a text.
    pub fn text(&mut self, text: &str) {
        text.bytes().for_each(|byte| self.word(byte.into()));
    }

    /// The hash of what was added.
    pub fn finish(self) -> u128 {
        self.0
    }
}

/// A hash as 32 hexadecimal digits.
pub fn hex(hash: u128) -> String {
    format!("{hash:032x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_the_published_hashes() {
        for (text, hash) in [
            ("", "6c62272e07bb014262b821756295c58d"),
            ("a", "d228cb696f1a8caf78912b704e4a8964"),
            ("foobar", "343e1662793c64bf6f0d3597ba446f18"),
        ] {
            let mut digest = Digest::new();
            digest.text(text);
            assert_eq!(hex(digest.finish()), hash);
        }
    }
}
