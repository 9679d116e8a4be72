//! What the pages have in common: the report of `cg estimate --report` and the live page of `cg run --serve`.
//!
//! A page is one file: a template into which its style and its script are inserted. It loads nothing.

/// Colors of light and dark screens, text, tiles and curves.
pub const STYLE: &str = include_str!("base.css");
/// Creation of elements, scales, axes and curves.
pub const SCRIPT: &str = include_str!("chart.js");

/// Inserts the parts into the template at their marks, which stand in this order. Inserted text is not searched
/// for marks.
#[must_use]
pub fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let length: usize = parts.iter().map(|(_, part)| part.len()).sum();
    let mut page = String::with_capacity(template.len() + length);
    let mut rest = template;
    for (mark, part) in parts {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        page.push_str(before);
        page.push_str(part);
        rest = after;
    }
    page + rest
}

/// Checks that a page is complete and refers to nothing elsewhere.
#[cfg(test)]
pub(crate) fn check(page: &str) {
    assert!(!page.contains("{{"));
    assert!(page.ends_with("</html>\n"));
    // The name of SVG is not an address.
    assert_eq!(page.matches("http://").count(), 1);
    assert!(!page.contains("https://"));
}
