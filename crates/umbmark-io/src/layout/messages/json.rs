//! Messages in JSON, as Foxglove and web tools write them.

use super::fields::{Fields, Layout, Slot, same_field};
use serde_json::Value;

/// Decodes a message, and visits it, or each message of its list.
pub(in crate::layout) fn read<E>(
    layout: &Layout,
    data: &[u8],
    fields: &mut Fields,
    visit: &mut dyn FnMut(&Fields) -> Result<(), E>,
) -> Result<Result<(), E>, String> {
    let document: Value = serde_json::from_slice(data).map_err(|error| format!("is not valid JSON: {error}"))?;
    let Some(each) = layout.each else {
        take(layout, &document, fields)?;
        return Ok(visit(fields));
    };
    let list = document.get(each).and_then(Value::as_array).ok_or_else(|| format!("has no list {each}"))?;
    for item in list {
        take(layout, item, fields)?;
        if let Err(error) = visit(fields) {
            return Ok(Err(error));
        }
    }
    Ok(Ok(()))
}

fn take(layout: &Layout, document: &Value, fields: &mut Fields) -> Result<(), String> {
    fields.clear();
    for wanted in &layout.wanted {
        let value = wanted.path.split('.').try_fold(document, member);
        let taken = value.and_then(|value| put(wanted.slot, value, fields));
        if taken.is_none() && wanted.needed {
            let found = value.map_or("no field".to_owned(), |_| "no usable field".to_owned());
            return Err(format!("has {found} {}", wanted.path));
        }
    }
    Ok(())
}

fn member<'v>(value: &'v Value, name: &str) -> Option<&'v Value> {
    let object = value.as_object()?;
    object.get(name).or_else(|| object.iter().find(|(key, _)| same_field(key, name)).map(|(_, value)| value))
}

fn put(slot: Slot, value: &Value, fields: &mut Fields) -> Option<()> {
    match slot {
        Slot::Number(number) => fields.set(number, value.as_f64()?),
        Slot::Frame | Slot::Child => fields.set_text(slot, value.as_str()?),
        Slot::Names => {
            for name in value.as_array()? {
                fields.names.push(name.as_str()?);
            }
        }
        Slot::Values => {
            for value in value.as_array()? {
                fields.values.push(value.as_f64()?);
            }
        }
    }
    Some(())
}
