//! How the API's description shows sentences ([`Sentence`]), which `text/sentence` lists.
//!
//! Main types: [`SentenceSchema`] and [`SentenceArgsSchema`], which fields name as their `value_type`. Main function:
//! [`kept_parts`], which splits a sentence as a database keeps it. Refuses: to make sentences.

use giveway_floor::text::{Sentence, SentenceArgs};
use std::borrow::Cow;
use utoipa::openapi::schema::{AdditionalProperties, SchemaType};
use utoipa::openapi::{ArrayBuilder, ObjectBuilder, OneOfBuilder, Ref, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// Code, arguments and text of a sentence, as far as it has them.
pub type SentenceParts = (Option<&'static str>, Option<SentenceArgs>, Option<String>);

/// The parts of a sentence as a database keeps it. A sentence without a code has no arguments.
pub fn kept_parts(kept: Option<String>) -> SentenceParts {
    let Some(kept) = kept else { return SentenceParts::default() };
    let (code, args, text) = Sentence::read(&kept).into_parts();
    let args = code.is_some().then_some(args);
    (code, args, Some(text))
}

/// The schema `SentenceArgs`.
pub struct SentenceArgsSchema;

/// The schema `Sentence`.
pub struct SentenceSchema;

impl PartialSchema for SentenceArgsSchema {
    fn schema() -> RefOr<Schema> {
        let item = || {
            OneOfBuilder::new()
                .item(ObjectBuilder::new().schema_type(Type::String))
                .item(ObjectBuilder::new().schema_type(Type::Number))
                .item(Ref::from_schema_name("Sentence"))
        };
        let arg = item().item(ArrayBuilder::new().items(item()));
        ObjectBuilder::new()
            .schema_type(Type::Object)
            .additional_properties(Some(AdditionalProperties::RefOr(RefOr::T(Schema::OneOf(arg.build())))))
            .description(Some(
                "What stands in the places of a sentence, by their names: texts, numbers, sentences, or lists of them.",
            ))
            .build()
            .into()
    }
}

impl ToSchema for SentenceArgsSchema {
    fn name() -> Cow<'static, str> {
        "SentenceArgs".into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push(("Sentence".into(), SentenceSchema::schema()));
    }
}

impl PartialSchema for SentenceSchema {
    fn schema() -> RefOr<Schema> {
        let text = ObjectBuilder::new().schema_type(Type::String).description(Some("The same in English."));
        let code = ObjectBuilder::new()
            .schema_type(SchemaType::from_iter([Type::String, Type::Null]))
            .description(Some("Which sentence it is; null for texts of versions that had no codes."))
            .examples(["waits_for"]);
        ObjectBuilder::new()
            .schema_type(Type::Object)
            .property("code", code)
            .required("code")
            .property("args", Ref::from_schema_name("SentenceArgs"))
            .required("args")
            .property("text", text)
            .required("text")
            .description(Some(
                "What is said to people: a code, what stands in its places, and the same in English. Codes and the \
                 names of places stay what they are; texts may change.",
            ))
            .build()
            .into()
    }
}

impl ToSchema for SentenceSchema {
    fn name() -> Cow<'static, str> {
        "Sentence".into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push(("SentenceArgs".into(), SentenceArgsSchema::schema()));
    }
}
