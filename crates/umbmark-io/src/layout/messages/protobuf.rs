//! Messages in protocol buffers, decoded by the descriptors that are in the file.

use super::fields::{Fields, Layout, Slot, same_field};
use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor, ReflectMessage, Value};
use std::borrow::Cow;
use std::panic::catch_unwind;

/// The type `name` of a schema, which is a set of file descriptors.
pub(in crate::layout) fn descriptor(name: &str, data: &[u8]) -> Result<MessageDescriptor, String> {
    // Descriptors without a name where one must be make the crate look for the name in a file that is not there yet.
    let decoded = catch_unwind(|| DescriptorPool::decode(data));
    let none = "its schema is no set of protobuf descriptors";
    let pool = decoded.ok().and_then(Result::ok).ok_or_else(|| none.to_owned())?;
    let missing = || format!("its schema does not define {}", crate::error::quoted(name));
    pool.get_message_by_name(name).ok_or_else(missing)
}

/// Decodes a message and visits it.
pub(in crate::layout) fn read<E>(
    descriptor: &MessageDescriptor,
    layout: &Layout,
    data: &[u8],
    fields: &mut Fields,
    visit: &mut dyn FnMut(&Fields) -> Result<(), E>,
) -> Result<Result<(), E>, String> {
    let message = DynamicMessage::decode(descriptor.clone(), data)
        .map_err(|_| "does not fit its protobuf descriptor".to_owned())?;
    fields.clear();
    for wanted in &layout.wanted {
        let taken = find(&message, &wanted.path).and_then(|value| put(wanted.slot, &value, fields));
        if taken.is_none() && wanted.needed {
            return Err(format!("has no usable field {}", wanted.path));
        }
    }
    Ok(visit(fields))
}

fn find<'m>(message: &'m DynamicMessage, path: &str) -> Option<Cow<'m, Value>> {
    let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
    let field = message.descriptor().fields().find(|field| same_field(field.name(), first))?;
    let value = message.get_field(&field);
    match (rest, value) {
        (None, value) => Some(value),
        (Some(rest), Cow::Borrowed(value)) => find(value.as_message()?, rest),
        (Some(rest), Cow::Owned(value)) => find(value.as_message()?, rest).map(|value| Cow::Owned(value.into_owned())),
    }
}

fn put(slot: Slot, value: &Value, fields: &mut Fields) -> Option<()> {
    match slot {
        Slot::Number(place) => fields.set(place, number(value)?),
        Slot::Frame | Slot::Child => fields.set_text(slot, value.as_str()?),
        Slot::Names => {
            for name in value.as_list()? {
                fields.names.push(name.as_str()?);
            }
        }
        Slot::Values => {
            for value in value.as_list()? {
                fields.values.push(number(value)?);
            }
        }
    }
    Some(())
}

fn number(value: &Value) -> Option<f64> {
    Some(match value {
        Value::I32(value) => f64::from(*value),
        Value::I64(value) => *value as f64,
        Value::U32(value) => f64::from(*value),
        Value::U64(value) => *value as f64,
        Value::F32(value) => f64::from(*value),
        Value::F64(value) => *value,
        _ => return None,
    })
}
