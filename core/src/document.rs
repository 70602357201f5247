//! The contents of a file of settings, in no format: [documents](kalmanscope_records::document) that may have equations.

use serde::Deserialize as _;
use serde::de::DeserializeOwned;

use kalmanscope_filters::catalogue::KnownChannels;

use crate::PlantKind;
use crate::equation::EquationSettings;

pub use kalmanscope_records::document::*;

/// Reads a value. Keys of channels are those of [`Channel::all`](crate::Channel::all) and of the equations in the document.
///
/// # Errors
/// [`DocumentError`] with the path of the key and the reason.
pub fn read<T: DeserializeOwned>(document: &Document) -> Result<T, DocumentError> {
    let mut plants = Vec::new();
    equations(document, &mut plants);
    let _known = KnownChannels::new(plants.iter().flat_map(PlantKind::channels).copied());
    kalmanscope_records::document::read(document)
}

/// Reads a value from a text of JSON.
///
/// # Errors
/// [`DocumentError`] where the text is not JSON, or not a value of this type.
pub fn read_json<T: DeserializeOwned>(text: &str) -> Result<T, DocumentError> {
    read(&from_json(text)?)
}

/// Reads a value from a text of TOML.
///
/// # Errors
/// [`DocumentError`] as of [`from_toml`], or where it is no value of this type: with line, path of the key and reason.
pub fn read_toml<T: DeserializeOwned>(text: &str) -> Result<T, DocumentError> {
    read(&from_toml(text)?).map_err(|error| error.in_toml(text))
}

/// Parameters of these plants have keys wherever they stand. A text that is no equation is reported where it is read.
fn equations(document: &Document, plants: &mut Vec<PlantKind>) {
    match document {
        Document::Object(entries) => {
            if let Some(equation) = entries.get("equation") {
                let alone =
                    json!({ "equation": equation, "parameters": entries.get("parameters").unwrap_or(&json!({})) });
                let plant =
                    EquationSettings::deserialize(&alone).ok().and_then(|one| PlantKind::of_equation(&one).ok());
                plants.extend(plant);
            }
            entries.values().for_each(|value| equations(value, plants));
        }
        Document::Array(values) => values.iter().for_each(|value| equations(value, plants)),
        _ => {}
    }
}
