//! The vehicle file for people and editors, made from the table of its keys ([`crate::check`]).
//!
//! | file | contents |
//! |---|---|
//! | `tree` | the tables of the file as a tree |
//! | `template` | a commented file with typical values for a kind of truck |
//! | `changed` | the text of a file with other values of some keys |
//! | `schema` | the JSON schema of the file, with which editors check it |
//! | `page` | the page of the documentation that lists every key |

mod tree;
mod template;
mod changed;
mod schema;
mod page;

pub use changed::changed;
pub use page::page;
pub use schema::schema;
pub use template::{TruckKind, template};
