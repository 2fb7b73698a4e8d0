//! Animations of what is no node: numbers of the JSON itself, named by pointers into it (KHR_animation_pointer, RFC 6901).

use serde_json::{Map, Value};

use super::document;
use crate::scene::Unplaced;
use crate::scene_io::budget::Budget;

/// What the pointer of a channel names.
pub enum Target<'p> {
    /// What a channel of a node may change, too: its number, and which.
    Node(usize, &'p str),
    /// Some other number or list of numbers.
    Property,
}

/// The value of a property at a moment.
pub struct Setting {
    /// Of the channel, for errors.
    pub owner: String,
    pub pointer: String,
    pub numbers: Vec<f64>,
}

/// Lists whose elements may change. Others say where a file's bytes are and what hangs on what.
const LISTS: [&str; 5] = ["/cameras/", "/materials/", "/meshes/", "/nodes/", "/extensions/KHR_lights_punctual/lights/"];

/// What a pointer names.
///
/// # Errors
/// Nothing that an animation may change.
pub fn target<'p>(pointer: &'p str, owner: &str) -> Unplaced<Target<'p>> {
    if let Some((node, path)) = pointer.strip_prefix("/nodes/").and_then(|rest| rest.split_once('/'))
        && let (Ok(node), "translation" | "rotation" | "scale" | "weights") = (node.parse(), path)
    {
        return Ok(Target::Node(node, path));
    }
    if LISTS.iter().any(|list| pointer.starts_with(list)) {
        return Ok(Target::Property);
    }
    Err(format!(
        "{owner}: the pointer {pointer:?} names nothing that is drawn; animate nodes, cameras, lights or materials"
    ))
}

/// The JSON of a file with properties as animations have them.
///
/// # Errors
/// A pointer that leads to no number, or more than the budget has room for.
pub fn patched(json: &[u8], settings: &[Setting], budget: &Budget) -> Unplaced<Vec<u8>> {
    // A tree of values takes at most so many times its text, which is read again then.
    const TREE: u64 = 40;
    budget
        .check_bytes(TREE.saturating_mul(json.len() as u64))
        .map_err(|why| format!("its JSON, of which animations change numbers, would {why}; split the file"))?;
    let mut all: Value = serde_json::from_slice(document::text(json)).map_err(|fault| format!("the JSON: {fault}"))?;
    for Setting { owner, pointer, numbers } in settings {
        let fault = |why: &str| format!("{owner}: the pointer {pointer:?} {why}; mend it, or leave the animation out");
        let place = place(&mut all, pointer).ok_or_else(|| fault("names an element that is not there"))?;
        let number = |number: f64| serde_json::Number::from_f64(number).map(Value::Number);
        let list = numbers.iter().map(|&of| number(of)).collect::<Option<Vec<Value>>>();
        let list = list.ok_or_else(|| fault("gets a number that is not finite"))?;
        *place = match (&*place, list) {
            (Value::String(_) | Value::Object(_), _) => return Err(fault("names no number")),
            (Value::Bool(_), list) => Value::Bool(list.first().and_then(Value::as_f64) != Some(0.0)),
            (Value::Array(_), list) => Value::Array(list),
            // What is not said is one number, or a list, by what the animation says.
            (_, list) => {
                if let [only] = &list[..] {
                    only.clone()
                } else {
                    Value::Array(list)
                }
            }
        };
    }
    serde_json::to_vec(&all).map_err(|fault| fault.to_string())
}

/// The place of a pointer. What an element of a list does not say is made; lists and elements are not.
fn place<'v>(all: &'v mut Value, pointer: &str) -> Option<&'v mut Value> {
    let (mut at, mut is_in_element) = (all, false);
    for token in pointer.strip_prefix('/')?.split('/') {
        let name = token.replace("~1", "/").replace("~0", "~");
        if at.is_null() {
            *at = Value::Object(Map::new());
        }
        at = match at {
            Value::Array(list) => {
                is_in_element = true;
                list.get_mut(name.parse::<usize>().ok()?)?
            }
            Value::Object(of) if is_in_element || of.contains_key(&name) => of.entry(name).or_insert(Value::Null),
            _ => return None,
        };
    }
    Some(at)
}
