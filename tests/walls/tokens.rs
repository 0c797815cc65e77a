//! Rust source as words and signs: enough to see paths and functions.

#[derive(Clone, Copy, Debug)]
pub struct Token<'a> {
    pub line: usize,
    pub text: &'a str,
}

/// Words, `::` and signs; without comments, texts, numbers and lifetimes.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let bytes = text.as_bytes();
    let (mut i, mut line, mut found) = (0, 1, Vec::new());
    while i < bytes.len() {
        let rest = &text[i..];
        let step = match bytes[i] {
            b'/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            b'/' if rest.starts_with("/*") => block_comment(rest),
            b'"' => plain_text(rest, 1),
            b'b' if rest.starts_with("b\"") => plain_text(rest, 2),
            b'r' | b'b' if raw_text(rest).is_some() => raw_text(rest).expect("just seen"),
            b'\'' => letter_or_lifetime(rest),
            b':' if rest.starts_with("::") => 2,
            b if b.is_ascii_alphanumeric() || b == b'_' => {
                rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
            }
            _ => rest.chars().next().map_or(1, char::len_utf8),
        };
        let token = &text[i..i + step];
        let first = bytes[i];
        let is_word = first.is_ascii_alphabetic() || first == b'_';
        let is_text = is_word && token.contains('"');
        let is_sign = first.is_ascii_punctuation() && !"\"'".contains(first as char) && token.len() <= 2;
        if (is_word && !is_text) || (is_sign && !token.starts_with("//")) {
            found.push(Token { line, text: token });
        }
        line += token.matches('\n').count();
        i += step;
    }
    found
}

fn block_comment(rest: &str) -> usize {
    let (mut depth, mut i) = (0, 0);
    while i < rest.len() {
        match &rest.as_bytes()[i..] {
            [b'/', b'*', ..] => (depth, i) = (depth + 1, i + 2),
            [b'*', b'/', ..] if depth == 1 => return i + 2,
            [b'*', b'/', ..] => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
    }
    rest.len()
}

/// The length of a text whose first quote ends at `from`.
fn plain_text(rest: &str, from: usize) -> usize {
    let mut escaped = false;
    for (i, b) in rest.bytes().enumerate().skip(from) {
        match b {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return i + 1,
            _ => {}
        }
    }
    rest.len()
}

fn raw_text(rest: &str) -> Option<usize> {
    let after = rest.strip_prefix("br").or(rest.strip_prefix('r'))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let start = rest.len() - body.len();
    Some(body.find(&end).map_or(rest.len(), |i| start + i + end.len()))
}

/// `'a'`, `'\n'` are letters; `'a` is a lifetime.
fn letter_or_lifetime(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some(_)) => rest[3..].find('\'').map_or(rest.len(), |i| i + 4),
        (Some(_), Some((i, '\''))) => i + 1,
        _ => rest[1..].find(|c: char| !c.is_alphanumeric() && c != '_').map_or(rest.len(), |i| i + 1),
    }
}

/// The index behind the bracket that closes the one at `open`.
fn behind_block(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0;
    for (i, t) in tokens.iter().enumerate().skip(open) {
        match t.text {
            "{" => depth += 1,
            "}" if depth == 1 => return i + 1,
            "}" => depth -= 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Leaves out every item under `#[cfg(test)]`.
pub fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let marker = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut i, mut kept) = (0, Vec::new());
    while i < tokens.len() {
        let marked = tokens[i..].iter().map(|t| t.text).take(marker.len()).eq(marker);
        if !marked {
            kept.push(tokens[i]);
            i += 1;
            continue;
        }
        let end = (i..tokens.len()).find(|j| ["{", ";"].contains(&tokens[*j].text));
        i = match end {
            Some(j) if tokens[j].text == "{" => behind_block(tokens, j),
            Some(j) => j + 1,
            None => tokens.len(),
        };
    }
    kept
}

/// Every path as its segments, groups in braces taken apart.
pub fn paths<'a>(tokens: &[Token<'a>]) -> Vec<(usize, Vec<&'a str>)> {
    let mut found = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let goes_on = i > 0 && ["::", "."].contains(&tokens[i - 1].text);
        i = if is_word(tokens[i]) && !goes_on { path(tokens, i, &[], &mut found) } else { i + 1 };
    }
    found
}

fn is_word(t: Token<'_>) -> bool {
    t.text.starts_with(|c: char| c.is_alphabetic() || c == '_') || t.text == "*"
}

/// One path from the word at `i` on; gives the index behind it.
fn path<'a>(
    tokens: &[Token<'a>],
    mut i: usize,
    prefix: &[&'a str],
    found: &mut Vec<(usize, Vec<&'a str>)>,
) -> usize {
    let (line, mut segments) = (tokens[i].line, prefix.to_vec());
    segments.push(tokens[i].text);
    i += 1;
    while tokens.get(i).is_some_and(|t| t.text == "::") {
        match tokens.get(i + 1) {
            Some(t) if is_word(*t) => {
                segments.push(t.text);
                i += 2;
            }
            Some(t) if t.text == "{" => {
                let end = behind_block(tokens, i + 1);
                i += 2;
                while i + 1 < end {
                    i = if is_word(tokens[i]) { path(tokens, i, &segments, found) } else { i + 1 };
                }
                return end;
            }
            _ => break,
        }
    }
    found.push((line, segments));
    i
}

/// Every function with a body: line, name, lines.
pub fn functions<'a>(tokens: &[Token<'a>]) -> Vec<(usize, &'a str, usize)> {
    let mut found = Vec::new();
    for (i, pair) in tokens.windows(2).enumerate() {
        if pair[0].text != "fn" || !is_word(pair[1]) {
            continue;
        }
        let mut depth = 0;
        let body = (i..tokens.len()).find(|j| {
            match tokens[*j].text {
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                _ => {}
            }
            depth == 0 && ["{", ";"].contains(&tokens[*j].text)
        });
        if let Some(open) = body.filter(|j| tokens[*j].text == "{") {
            let last = tokens[behind_block(tokens, open) - 1].line;
            found.push((pair[0].line, pair[1].text, last + 1 - pair[0].line));
        }
    }
    found
}
