//! A design as text for firmware: JSON, Rust or C, in single precision.
//!
//! Each number is written with the fewest digits that give the same bits when it is read.

use std::fmt::Write;

use cg_core::{
    Articulation, ChannelDesign, Design, Friction, PathLead, RatioLine, Reduced5, RolloverDesign,
    Spread, ThresholdLine,
};

/// The language of the emitted text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Language {
    /// One object with the design's fields; the comment is its key `comment`.
    Json,
    /// `pub const DESIGN: cg_core::Design<f32>`.
    Rust,
    /// `static const cg_design CG_DESIGN`, for `cg_height.h`.
    C,
}

cg_core::words!(Language {
    Json => "json", "One object";
    Rust => "rust", "A constant of cg-core's `Design<f32>`";
    C => "c", "A constant for `cg_height.h`";
});

/// Numbers in arrays and structures.
enum Node {
    Number(f32),
    Whole(u32),
    Array(Vec<Node>),
    Struct(&'static str, Vec<(&'static str, Node)>),
}

trait Tree {
    fn tree(&self) -> Node;
}

impl Tree for f32 {
    fn tree(&self) -> Node {
        Node::Number(*self)
    }
}

impl Tree for u32 {
    fn tree(&self) -> Node {
        Node::Whole(*self)
    }
}

impl<E: Tree, const N: usize> Tree for [E; N] {
    fn tree(&self) -> Node {
        Node::Array(self.iter().map(Tree::tree).collect())
    }
}

/// All fields are listed here. A missing field is a compile error.
macro_rules! structures {
    ($($name:ident $(<$channels:ident>)? { $($field:ident),+ $(,)? })+) => {
        $(impl $(<const $channels: usize>)? Tree for $name<f32 $(, $channels)?> {
            fn tree(&self) -> Node {
                let Self { $($field),+ } = self;
                Node::Struct(stringify!($name), vec![$((stringify!($field), $field.tree())),+])
            }
        })+
    };
}

structures! {
    Design<C> {
        speed_mps, trailer_mass_kg, channels, spread, nominal_speed_mps, nominal_trailer_mass_kg,
        reference_height_m, least_height_m, greatest_height_m, trailer_wheelbase_m,
        path_lead, gravity_mps2, rollover, thresholds,
    }
    ChannelDesign { index, models, friction, of_lines, articulation, lines, compensation }
    Articulation { mean, sd }
    PathLead { ahead_m, slip_s2_per_m }
    Friction { usual_share, bend, knee_rad, roll_rad, deflection_rad }
    Reduced5 { numerator, denominator, speed_slope }
    RatioLine { a0, a1, b0, b1 }
    Spread<C> { covariance }
    RolloverDesign {
        half_track_m, unsprung_mass_kg, unsprung_height_m, payload_beside_sd_m, tightest_turn_g,
    }
    ThresholdLine { threshold_g }
}

impl Node {
    fn is_short(&self) -> bool {
        let number = |node: &Self| matches!(node, Self::Number(_) | Self::Whole(_));
        match self {
            Self::Number(_) | Self::Whole(_) => true,
            Self::Array(items) => items.iter().all(number),
            Self::Struct(_, fields) => {
                fields.len() < 5 && fields.iter().all(|(_, value)| value.is_short())
            }
        }
    }

    fn write(&self, language: Language, depth: usize, out: &mut String) {
        let (open, close, items): (String, char, Vec<(String, &Self)>) = match self {
            // `{:?}` writes the fewest digits that give the same float when it is read.
            Self::Number(value) => {
                let suffix = if language == Language::C { "f" } else { "" };
                let _ = write!(out, "{value:?}{suffix}"); // writing to a string cannot fail
                return;
            }
            Self::Whole(value) => {
                let _ = write!(out, "{value}");
                return;
            }
            Self::Array(items) => {
                let (open, close) = if language == Language::C { ("{", '}') } else { ("[", ']') };
                (open.into(), close, items.iter().map(|item| (String::new(), item)).collect())
            }
            Self::Struct(name, fields) => {
                let open = match language {
                    Language::Rust => format!("cg_core::{name} {{"),
                    Language::Json | Language::C => "{".into(),
                };
                let label = |field: &str| match language {
                    Language::Json => format!("\"{field}\": "),
                    Language::Rust => format!("{field}: "),
                    Language::C => format!(".{field} = "),
                };
                (open, '}', fields.iter().map(|(field, value)| (label(field), value)).collect())
            }
        };
        out.push_str(&open);
        let short = self.is_short();
        let padding = if short && close == '}' { " " } else { "" };
        for (k, (label, item)) in items.iter().enumerate() {
            if short {
                out.push_str(if k == 0 { padding } else { ", " });
            } else {
                out.push_str(if k == 0 { "\n" } else { ",\n" });
                out.push_str(&"    ".repeat(depth + 1));
            }
            out.push_str(label);
            item.write(language, depth + 1, out);
        }
        if short {
            out.push_str(padding);
        } else {
            // JSON does not allow a comma after the last item.
            out.push_str(if language == Language::Json { "\n" } else { ",\n" });
            out.push_str(&"    ".repeat(depth));
        }
        out.push(close);
    }
}

/// The text of `design` in a language, preceded by a comment of several lines.
pub fn emit<const C: usize>(
    design: &Design<f32, C>,
    language: Language,
    comment: &[String],
) -> String {
    let mut body = String::new();
    design.tree().write(language, 0, &mut body);
    let lines = |mark: &str| comment.iter().flat_map(|line| [mark, line, "\n"]).collect::<String>();
    match language {
        Language::Json => {
            let quoted = serde_json::Value::from(comment.join(" ")).to_string();
            format!("{{\n    \"comment\": {quoted},{}\n", body.trim_start_matches('{'))
        }
        Language::Rust => format!(
            "{}\n/// The constants of this truck.\n#[allow(clippy::unreadable_literal)]\n\
             #[rustfmt::skip]\npub const DESIGN: cg_core::Design<f32, {C}> = {body};\n",
            lines("// ")
        ),
        Language::C => format!(
            "{}\n#include \"cg_height.h\"\n\nstatic const cg_design CG_DESIGN = {body};\n",
            // Line comments, because a file name could end a block comment.
            lines("// ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::design;
    use crate::equations::Variant;
    use crate::vehicle::Vehicle;

    fn baseline() -> Design<f32> {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
        design(&Vehicle::load(path).unwrap(), Variant::Complete).unwrap().cast()
    }

    fn numbers(node: &Node, into: &mut Vec<u32>) {
        match node {
            Node::Number(value) => into.push(value.to_bits()),
            Node::Whole(value) => into.push(*value),
            Node::Array(items) => items.iter().for_each(|item| numbers(item, into)),
            Node::Struct(_, fields) => fields.iter().for_each(|(_, value)| numbers(value, into)),
        }
    }

    /// The numbers of the JSON text, by the fields of the design.
    fn read(node: &Node, json: &serde_json::Value, into: &mut Vec<u32>) {
        match node {
            #[allow(clippy::cast_possible_truncation)] // the type from which it was written
            Node::Number(_) => into.push((json.as_f64().unwrap() as f32).to_bits()),
            Node::Whole(_) => into.push(u32::try_from(json.as_u64().unwrap()).unwrap()),
            Node::Array(items) => {
                assert_eq!(json.as_array().unwrap().len(), items.len());
                items.iter().enumerate().for_each(|(k, item)| read(item, &json[k], into));
            }
            Node::Struct(_, fields) => {
                for (field, value) in fields {
                    read(value, &json[field], into);
                }
            }
        }
    }

    #[test]
    fn json_reads_back_to_the_same_bits() {
        let design = baseline();
        let comment = ["a \"quoted\" name".to_owned(), "made so".to_owned()];
        let text = emit(&design, Language::Json, &comment);
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["comment"], "a \"quoted\" name made so");
        let (mut before, mut after) = (Vec::new(), Vec::new());
        numbers(&design.tree(), &mut before);
        read(&design.tree(), &json, &mut after);
        assert_eq!(before, after);
        // The text contains all of the design, and nothing else except the comment.
        assert_eq!(size_of::<Design<f32>>(), 4 * before.len());
        let Node::Struct(_, fields) = design.tree() else { panic!("a structure") };
        assert_eq!(json.as_object().unwrap().len(), 1 + fields.len());
    }

    #[test]
    fn every_language_writes_the_same_numbers() {
        let design = baseline();
        let digits = |language, suffix: &str| {
            let text = emit(&design, language, &[]);
            let body = &text[text.find("speed_mps").unwrap()..];
            let numbers: Vec<u32> = body
                .split(|c: char| !(c.is_alphanumeric() || "+-._".contains(c)))
                .filter_map(|word| {
                    let number = word.strip_suffix(suffix).unwrap_or(word);
                    // A number without a point is an index.
                    number.parse::<u32>().ok().or(number.parse().map(f32::to_bits).ok())
                })
                .collect();
            numbers
        };
        let mut expected = Vec::new();
        numbers(&design.tree(), &mut expected);
        assert_eq!(digits(Language::Rust, ""), expected);
        assert_eq!(digits(Language::C, "f"), expected);
    }
}
