//! Choreography scripts: TOML to [`Script`].

use std::collections::{BTreeMap, BTreeSet};

use kineme::Role;
use kineme::choreography::{Key, Script, ScriptAnimation, ScriptExemplar};

use crate::document::{Document, Value};
use crate::error::{FormatError, Result};

const VALID: &str = "a valid script";

/// Reads a script; what it returns passes [`Script::validate`].
///
/// # Errors
/// When the text is no TOML, a key or role is unknown, a value has the wrong type or is missing, or the
/// script breaks a rule of [`Script`]; the place is the line of the part at fault.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Script> {
    let (doc, root) = Document::open(name, bytes)?;
    let table = root.get_ref();
    doc.only(table, &["body", "exemplar", "animation"])?;
    let body = doc.name(doc.required(table, root.span(), "body")?)?;
    let mut script = Script {
        body: body.to_string(),
        exemplars: Vec::new(),
        animations: Vec::new(),
    };
    // Each part is checked as it comes, against the parts before it, for the line of the one at fault.
    let mut first_of: BTreeMap<String, usize> = BTreeMap::new();
    for value in items(&doc, table.get("exemplar"))? {
        let exemplar = exemplar(&doc, value)?;
        let first = *first_of
            .entry(exemplar.primitive.clone())
            .or_insert(script.exemplars.len());
        exemplar
            .validate()
            .and_then(|()| match script.exemplars.get(first) {
                Some(first) => exemplar.agrees_with(first),
                None => Ok(()),
            })
            .map_err(|e| refusal(&doc, value, &e))?;
        script.exemplars.push(exemplar);
    }
    let mut names = BTreeSet::new();
    for value in items(&doc, table.get("animation"))? {
        let animation = animation(&doc, value)?;
        animation.validate().map_err(|e| refusal(&doc, value, &e))?;
        if !names.insert(animation.name.clone()) {
            let found = format!("a second animation `{}`", animation.name);
            return Err(doc.error(value.span(), found, "names used once"));
        }
        script.animations.push(animation);
    }
    script
        .validate()
        .map_err(|e| doc.error(root.span(), e.to_string(), VALID))?;
    Ok(script)
}

fn items<'a, 't>(doc: &Document<'t>, list: Option<&'a Value<'t>>) -> Result<Vec<&'a Value<'t>>> {
    list.map_or(Ok(Vec::new()), |list| Ok(doc.array(list)?.collect()))
}

fn exemplar(doc: &Document<'_>, value: &Value<'_>) -> Result<ScriptExemplar> {
    let table = doc.table(value)?;
    doc.only(table, &["primitive", "parameters", "keys"])?;
    let mut parameters = BTreeMap::new();
    if let Some(listed) = table.get("parameters") {
        for (name, value) in doc.table(listed)? {
            parameters.insert(name.get_ref().to_string(), doc.number(value)?);
        }
    }
    Ok(ScriptExemplar {
        primitive: doc
            .name(doc.required(table, value.span(), "primitive")?)?
            .to_string(),
        parameters,
        keys: keys(doc, doc.required(table, value.span(), "keys")?)?,
    })
}

fn animation(doc: &Document<'_>, value: &Value<'_>) -> Result<ScriptAnimation> {
    let table = doc.table(value)?;
    doc.only(table, &["name", "keys"])?;
    Ok(ScriptAnimation {
        name: doc
            .name(doc.required(table, value.span(), "name")?)?
            .to_string(),
        keys: keys(doc, doc.required(table, value.span(), "keys")?)?,
    })
}

fn keys(doc: &Document<'_>, list: &Value<'_>) -> Result<Vec<Key>> {
    let mut keys: Vec<Key> = Vec::new();
    for value in doc.array(list)? {
        let key = key(doc, value)?;
        key.validate(keys.last())
            .map_err(|e| refusal(doc, value, &e))?;
        keys.push(key);
    }
    Ok(keys)
}

fn key(doc: &Document<'_>, value: &Value<'_>) -> Result<Key> {
    let table = doc.table(value)?;
    let time = doc.number(doc.required(table, value.span(), "time")?)?;
    let mut angles = BTreeMap::new();
    for (name, value) in table.iter().filter(|(name, _)| *name.get_ref() != "time") {
        let role = Role::parse(name.get_ref())
            .map_err(|e| doc.error(name.span(), e.to_string(), "`time` or a role"))?;
        let degrees = doc
            .array(value)?
            .map(|v| doc.number(v))
            .collect::<Result<_>>()?;
        angles.insert(role, degrees);
    }
    Ok(Key { time, angles })
}

fn refusal(doc: &Document<'_>, value: &Value<'_>, error: &kineme::Error) -> FormatError {
    doc.error(value.span(), error.to_string(), VALID)
}
