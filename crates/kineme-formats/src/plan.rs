//! Plans of behaviours: TOML to [`Plan`].

use kineme::control::{self, Aiming, Arbitration, Fault, Plan, Planned, Rule};
use toml::de::DeTable;

use crate::document::{Document, Value};
use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// Commands a second where the plan does not say.
const RATE_HZ: f64 = 120.0;
/// The keys of a behaviour, and of what a rule does.
const BEHAVIOR: [&str; 9] = [
    "primitive",
    "start",
    "repeat",
    "joints",
    "parameters",
    "reach",
    "weight",
    "priority",
    "pace",
];

/// A plan, and where its parts stand in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFile {
    /// The plan.
    pub plan: Plan,
    file: String,
    /// The lines on which each behaviour and each rule begins.
    behaviors: Vec<usize>,
    rules: Vec<usize>,
}

impl PlanFile {
    /// What [`Plan::check`] refuses, with the line of the part at fault.
    pub fn fault(&self, fault: &Fault) -> FormatError {
        let line = match fault.place {
            control::Place::Plan => None,
            control::Place::Behavior(index) => self.behaviors.get(index),
            control::Place::Rule(index) => self.rules.get(index),
        };
        let place = line.map_or(Place::File, |line| Place::Line(*line));
        FormatError::new(&self.file, place, &fault.message, "a plan that can be run")
    }
}

/// Reads a plan. Whether a vocabulary can run it, [`Plan::check`] says.
///
/// # Errors
/// When the text is no TOML, a key or word is unknown, a value has the wrong type or is missing, a behaviour has both
/// parameters and a point to reach, or nothing is planned; the place is the line of the part at fault.
pub fn parse(name: &str, bytes: &[u8]) -> Result<PlanFile> {
    let (doc, root) = Document::open(name, bytes)?;
    let table = root.get_ref();
    let known = [
        "rate_hz", "seconds", "arbiter", "observe", "behavior", "rule",
    ];
    doc.only(table, &known)?;
    let mut plan = Plan {
        rate_hz: number_or(&doc, table, "rate_hz", RATE_HZ)?,
        seconds: doc.number(doc.required(table, root.span(), "seconds")?)?,
        arbitration: table
            .get("arbiter")
            .map_or(Ok(Arbitration::default()), |value| arbiter(&doc, value))?,
        observed: table
            .get("observe")
            .map(|value| observed(&doc, value))
            .transpose()?,
        behaviors: Vec::new(),
        rules: Vec::new(),
    };
    let mut file = PlanFile {
        file: name.to_string(),
        behaviors: Vec::new(),
        rules: Vec::new(),
        plan: plan.clone(),
    };
    if let Some(list) = table.get("behavior") {
        for value in doc.array(list)? {
            plan.behaviors.push(planned(&doc, value)?);
            file.behaviors.push(doc.line(value.span()));
        }
    }
    if let Some(list) = table.get("rule") {
        for value in doc.array(list)? {
            plan.rules.push(rule(&doc, value)?);
            file.rules.push(doc.line(value.span()));
        }
    }
    if plan.behaviors.is_empty() && plan.rules.is_empty() {
        return Err(doc.error(
            root.span(),
            "nothing planned",
            "a [[behavior]] or a [[rule]]",
        ));
    }
    file.plan = plan;
    Ok(file)
}

fn arbiter(doc: &Document<'_>, value: &Value<'_>) -> Result<Arbitration> {
    match doc.name(value)? {
        "priority" => Ok(Arbitration::Priority),
        "winner" => Ok(Arbitration::Winner),
        "superposition" => Ok(Arbitration::Superposition),
        other => Err(doc.error(
            value.span(),
            quoted(other),
            "priority, winner or superposition",
        )),
    }
}

fn observed(doc: &Document<'_>, value: &Value<'_>) -> Result<String> {
    let table = doc.table(value)?;
    doc.only(table, &["motion"])?;
    let motion = doc.name(doc.required(table, value.span(), "motion")?)?;
    Ok(motion.to_string())
}

fn rule(doc: &Document<'_>, value: &Value<'_>) -> Result<Rule> {
    let table = doc.table(value)?;
    doc.only(table, &["when", "then"])?;
    let when = doc.name(doc.required(table, value.span(), "when")?)?;
    Ok(Rule {
        when: when.to_string(),
        then: planned(doc, doc.required(table, value.span(), "then")?)?,
    })
}

/// A behaviour; what it does not say is as [`Planned::new`] has it.
fn planned(doc: &Document<'_>, value: &Value<'_>) -> Result<Planned> {
    let table = doc.table(value)?;
    doc.only(table, &BEHAVIOR)?;
    let primitive = doc.name(doc.required(table, value.span(), "primitive")?)?;
    let usual = Planned::new(primitive);
    let mut joints = Vec::new();
    if let Some(listed) = table.get("joints") {
        for joint in doc.array(listed)? {
            joints.push(doc.name(joint)?.to_string());
        }
        if joints.is_empty() {
            let expected = "a part or joint; without `joints` those that the primitive moves";
            return Err(doc.error(listed.span(), "no joint", expected));
        }
    }
    let aim = match (table.get("parameters"), table.get("reach")) {
        (None, None) => Aiming::Middle,
        (Some(values), None) => {
            let values = doc.array(values)?.map(|v| doc.number(v));
            Aiming::Parameters(values.collect::<Result<_>>()?)
        }
        (None, Some(target)) => reach(doc, target)?,
        (Some(_), Some(target)) => {
            let found = "both `parameters` and `reach`";
            return Err(doc.error(
                target.span(),
                found,
                "one of them: a reach finds the parameters",
            ));
        }
    };
    Ok(Planned {
        start_secs: number_or(doc, table, "start", usual.start_secs)?,
        repeat: whole_or(doc, table, "repeat", usual.repeat)?,
        pace: number_or(doc, table, "pace", usual.pace)?,
        weight: number_or(doc, table, "weight", usual.weight)?,
        priority: whole_or(doc, table, "priority", usual.priority)?,
        joints,
        aim,
        ..usual
    })
}

fn reach(doc: &Document<'_>, value: &Value<'_>) -> Result<Aiming> {
    let table = doc.table(value)?;
    doc.only(table, &["effector", "at"])?;
    let effector = doc.name(doc.required(table, value.span(), "effector")?)?;
    let at = doc.required(table, value.span(), "at")?;
    let place: Vec<f64> = doc
        .array(at)?
        .map(|v| doc.number(v))
        .collect::<Result<_>>()?;
    let at = <[f64; 3]>::try_from(place).map_err(|place| {
        let found = format!("{} numbers", place.len());
        doc.error(at.span(), found, "three: metres forward, left and up")
    })?;
    Ok(Aiming::Reach {
        effector: effector.to_string(),
        at,
    })
}

fn number_or(doc: &Document<'_>, table: &DeTable<'_>, key: &str, usual: f64) -> Result<f64> {
    table.get(key).map_or(Ok(usual), |value| doc.number(value))
}

fn whole_or<T: TryFrom<i64>>(
    doc: &Document<'_>,
    table: &DeTable<'_>,
    key: &str,
    usual: T,
) -> Result<T> {
    table.get(key).map_or(Ok(usual), |value| doc.whole(value))
}
