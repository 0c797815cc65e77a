//! How each version spells the fields and the words of the messages: the difference of the versions, as data.
//!
//! Main types: [`WireName`] (the key of a field), [`WireWords`] (the words of an enumeration); the tables are in
//! [`names`] and [`words`]. A reader takes every spelling, a writer that of its version, and neither asks which version
//! it is. Refuses: to know what a field or a word means.

pub(crate) mod names;
pub(crate) mod words;

use crate::version::Version;

/// The key of a field in each version; a version without the field has none.
pub(crate) struct WireName {
    by_version: [Option<&'static str>; 3],
    also: &'static [&'static str],
}

impl WireName {
    /// A field that is called the same in all versions.
    const fn same(name: &'static str) -> WireName {
        WireName { by_version: [Some(name); 3], also: &[] }
    }

    /// A field that 3.0 has renamed.
    const fn renamed(before: &'static str, since: &'static str) -> WireName {
        WireName { by_version: [Some(before), Some(before), Some(since)], also: &[] }
    }

    /// A field that 3.0 no longer has.
    const fn until_2_1(name: &'static str) -> WireName {
        WireName { by_version: [Some(name), Some(name), None], also: &[] }
    }

    /// A field that is new in 2.1.
    const fn since_2_1(name: &'static str) -> WireName {
        WireName { by_version: [None, Some(name), Some(name)], also: &[] }
    }

    /// A field that is new in 3.0.
    const fn since_3_0(name: &'static str) -> WireName {
        WireName { by_version: [None, None, Some(name)], also: &[] }
    }

    /// The field with further official spellings, which are read without remark and never written.
    const fn also(self, also: &'static [&'static str]) -> WireName {
        WireName { by_version: self.by_version, also }
    }

    /// The key in a version, if the version has the field.
    pub(crate) fn of(&self, version: Version) -> Option<&'static str> {
        self.by_version[version as usize]
    }

    /// The key to name the field by: that of the version, or of any version that has the field.
    pub(crate) fn shown(&self, version: Version) -> &'static str {
        self.of(version).or_else(|| self.spellings().next()).unwrap_or("a field without a name")
    }

    /// All official keys of the field, oldest version first.
    pub(crate) fn spellings(&self) -> impl Iterator<Item = &'static str> {
        self.by_version.into_iter().flatten().chain(self.also.iter().copied())
    }
}

/// The words of an enumeration in each version.
pub(crate) struct WireWords<T: 'static> {
    /// A value and its word in each version. If a version has no word for a value, the row has the nearest one that
    /// does no harm, or none. A word is read as the first value that has it.
    rows: &'static [(T, [Option<&'static str>; 3])],
    /// The value for words that no version knows: the one on which the least is built.
    pub(crate) careful: Option<T>,
}

impl<T: Copy + PartialEq> WireWords<T> {
    /// The word for a value in a version, if it has any.
    pub(crate) fn word(&self, value: T, version: Version) -> Option<&'static str> {
        self.rows.iter().find(|(v, _)| *v == value).and_then(|(_, words)| words[version as usize])
    }

    /// The value of a word and the official spelling of the word: exact spellings first, then similar ones.
    pub(crate) fn value(&self, text: &str) -> Option<(T, &'static str)> {
        let with = |is_it: &dyn Fn(&str) -> bool| {
            let mut all = self.rows.iter().flat_map(|(v, words)| words.iter().flatten().map(|w| (*v, *w)));
            all.find(|(_, word)| is_it(word))
        };
        with(&|word| word == text).or_else(|| with(&|word| is_alike(word, text)))
    }
}

/// Whether two spellings differ in nothing but case, underscores, hyphens and blanks.
pub(crate) fn is_alike(one: &str, other: &str) -> bool {
    letters(one).eq(letters(other))
}

fn letters(text: &str) -> impl Iterator<Item = u8> {
    text.bytes().filter(|byte| !matches!(byte, b'_' | b'-' | b' ')).map(|byte| byte.to_ascii_lowercase())
}
