//! What is written can be read.

use super::kind_of;
use super::said::as_said;
use super::strategies::{Numbers, header, message};
use crate::{Header, Version, read, write};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn what_is_written_in_any_version_reads_as_it_was_up_to_what_the_version_cannot_say(
        header in header(), message in message(Numbers::Sane),
    ) {
        for version in Version::ALL.into_iter().filter(|version| kind_of(&message).is_in(*version)) {
            let payload = write(&header, &message, version).to_string();
            let read = read(kind_of(&message), payload.as_bytes()).expect("readable");
            prop_assert_eq!(&read.message, &as_said(&message, version), "{}", version);
            prop_assert_eq!(&read.header, &Header { version: version.text().to_owned(), ..header.clone() });
            prop_assert_eq!(&read.oddities, &[]);
        }
    }
}
