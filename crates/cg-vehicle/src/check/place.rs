//! The position of a finding in the text of a vehicle file.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::finding::Finding;

/// Adds the positions to findings and sorts them: errors first, then in the order of the file.
pub(super) fn located(mut findings: Vec<Finding>, text: &str) -> Vec<Finding> {
    if let Ok(root) = DeTable::parse(text) {
        for finding in &mut findings {
            (finding.line, finding.column) = place(text, &root, &finding.key);
        }
    }
    findings.sort_by_key(|finding| (finding.severity, finding.line, finding.column));
    findings
}

/// Line and column (from 1) of the value at `path` (`trailer.axle[1].tyre`). If the value is not in
/// the file, those of its nearest ancestor.
fn place(text: &str, root: &Spanned<DeTable<'_>>, path: &str) -> (usize, usize) {
    let mut offset = 0;
    let mut table = Some(root.get_ref());
    for step in path.split('.') {
        let mut parts = step.split('[');
        let name = parts.next().unwrap_or_default();
        let Some(mut entry) = table.and_then(|table| table.get(name)) else { break };
        offset = entry.span().start;
        for index in parts.map_while(|part| part.trim_end_matches(']').parse::<usize>().ok()) {
            let DeValue::Array(items) = entry.get_ref() else { break };
            let Some(item) = items.get(index) else { break };
            offset = item.span().start;
            entry = item;
        }
        table = match entry.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        };
    }
    let before = &text[..offset.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1;
    (line, column)
}
