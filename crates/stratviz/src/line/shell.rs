//! Words as a shell has them on a line, and back.

/// Words as one line for a shell.
pub fn line(words: &[String]) -> String {
    let quoted = |word: &String| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+^@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words: Vec<_> = words.iter().map(quoted).collect();
    format!("stratcli {}", words.join(" "))
}

/// Splits lines as a shell does, and drops what stands before each command: a prompt,
/// `stratcli`, a path to it, or `cargo run --release --`.
pub(super) fn lines(text: &str) -> Result<Vec<Vec<String>>, String> {
    let mut lines = vec![Vec::new()];
    let mut word: Option<String> = None;
    let mut quote = None;
    let mut chars = text.trim().chars();
    let add = |lines: &mut Vec<Vec<String>>, word: Option<String>| {
        if let Some(line) = lines.last_mut() {
            line.extend(word);
        }
    };
    while let Some(c) = chars.next() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            // A backslash before a line's end joins lines; before anything else it quotes.
            None if c == '\\' => {
                if let Some(next) = chars.next().filter(|next| *next != '\n') {
                    word.get_or_insert_default().push(next);
                }
            }
            None if c.is_whitespace() => {
                add(&mut lines, word.take());
                if c == '\n' {
                    lines.push(Vec::new());
                }
            }
            None => word.get_or_insert_default().push(c),
        }
    }
    if quote.is_some() {
        return Err("the line ends within a quotation; close it".to_owned());
    }
    add(&mut lines, word);
    let is_program = |word: &String| {
        word == "--" || word.rsplit('/').next().is_some_and(|name| name == "stratcli")
    };
    let after_program = |mut line: Vec<String>| match line.iter().position(is_program) {
        Some(at) => Ok(line.split_off(at + 1)),
        None => Err("paste a line that begins with stratcli, such as: stratcli pixel classic \
                     --at 77,156"
            .to_owned()),
    };
    lines.retain(|line| !line.is_empty());
    if lines.is_empty() {
        lines.push(Vec::new());
    }
    lines.into_iter().map(after_program).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_splits_into_the_words_that_made_it() {
        let words = ["pixel", "my scenes/a'b.toml", "--at", "1,2", "\\", "", "$HOME"];
        let words = words.map(str::to_owned);
        assert_eq!(lines(&line(&words)), Ok(vec![words.to_vec()]));
    }
}
