//! What Arrow's programs (pandas, polars, pyarrow) write into a parquet file beside its own schema:
//! parquet itself has no durations and no times in whole seconds, they are plain integers there.

use std::collections::HashMap;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use polars_arrow_format::ipc::planus::{self, ReadAsRoot};
use polars_arrow_format::ipc::{MessageHeaderRef, MessageRef, TimeUnit, TypeRef};

/// The key of Arrow's schema among those of the file.
pub(super) const KEY: &str = "ARROW:schema";

/// The units per second of the columns that are times or durations, by name; `None` if the text is no
/// schema.
pub(super) fn units_per_second(schema: &str) -> Option<HashMap<String, i64>> {
    let bytes = BASE64_STANDARD.decode(schema).ok()?;
    // Newer programs write a mark and the length before the message.
    let message = if bytes.starts_with(&[0xff; 4]) { bytes.get(8..)? } else { &bytes };
    of_message(message).ok()
}

fn of_message(message: &[u8]) -> planus::Result<HashMap<String, i64>> {
    let mut units = HashMap::new();
    let Some(MessageHeaderRef::Schema(schema)) = MessageRef::read_as_root(message)?.header()?
    else {
        return Ok(units);
    };
    for field in schema.fields()?.into_iter().flatten() {
        let field = field?;
        let unit = match field.type_()? {
            Some(TypeRef::Timestamp(time)) => time.unit()?,
            Some(TypeRef::Duration(time)) => time.unit()?,
            _ => continue,
        };
        let per_second = match unit {
            TimeUnit::Second => 1,
            TimeUnit::Millisecond => 1_000,
            TimeUnit::Microsecond => 1_000_000,
            TimeUnit::Nanosecond => 1_000_000_000,
        };
        units.insert(field.name()?.unwrap_or_default().to_owned(), per_second);
    }
    Ok(units)
}
