//! Messages of a topic decoded, whatever they are encoded in.

use super::fields::{Fields, Layout};
use super::message_type::{Encoding, MessageType};
use super::plan::Plan;
use super::schema::Schema;
use super::{json, protobuf};
use prost_reflect::MessageDescriptor;

/// How to decode the messages of a topic.
pub(in crate::layout) enum Decoder {
    Ros(Plan),
    Json(Layout),
    Protobuf(MessageDescriptor, Layout),
}

impl Decoder {
    /// The decoder of a type; says what its schema lacks.
    pub fn new(encoding: Encoding, kind: &MessageType, name: &str, schema: &[u8]) -> Result<Decoder, String> {
        Decoder::of_layout(encoding, kind.layout(), name, schema)
    }

    /// The decoder of some fields of a type; says what its schema lacks.
    pub fn of_layout(encoding: Encoding, layout: Layout, name: &str, schema: &[u8]) -> Result<Decoder, String> {
        Ok(match encoding {
            Encoding::Cdr | Encoding::Ros1 => {
                Decoder::Ros(Plan::new(encoding, &Schema::parse(name, schema)?, &layout)?)
            }
            Encoding::Json => Decoder::Json(layout),
            Encoding::Protobuf => Decoder::Protobuf(protobuf::descriptor(name, schema)?, layout),
        })
    }

    /// Decodes a message, and visits it, or each message of its list; says what is wrong with its bytes.
    pub fn read<E>(
        &self,
        data: &[u8],
        fields: &mut Fields,
        visit: &mut dyn FnMut(&Fields) -> Result<(), E>,
    ) -> Result<Result<(), E>, String> {
        match self {
            Decoder::Ros(plan) => plan.read(data, fields, visit),
            Decoder::Json(layout) => json::read(layout, data, fields, visit),
            Decoder::Protobuf(descriptor, layout) => protobuf::read(descriptor, layout, data, fields, visit),
        }
    }
}
