//! Options in messages. A library says which option mends what is wrong, but not how that is written:
//! its messages name options as `⟨speed_mps⟩` or `⟨flip roll⟩`, and whoever shows them to people (the
//! command line, Python) writes flags or keywords instead, with [`told`].

/// A message with its options written by `write_option`, which gets the name and the value (empty if
/// there is none).
///
/// ```
/// let flag = |name: &str, value: &str| format!("--{name} {value}");
/// let told = cg_vehicle::hint::told("the roll sensor is reversed (⟨flip roll⟩)", flag);
/// assert_eq!(told, "the roll sensor is reversed (--flip roll)");
/// ```
pub fn told(message: &str, write_option: impl Fn(&str, &str) -> String) -> String {
    let mut parts = message.split('⟨');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some((option, rest)) = part.split_once('⟩') else {
            text.extend(["⟨", part]);
            continue;
        };
        let (name, value) = option.split_once(' ').unwrap_or((option, ""));
        text.push_str(&write_option(name, value));
        text.push_str(rest);
    }
    text
}
