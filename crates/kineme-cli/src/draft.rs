//! A vocabulary while it is changed: primitives, and behaviors and transitions that follow.

use std::sync::Arc;

use kineme::{Behavior, Primitive, Skeleton, Transitions, Vocabulary};

use crate::args::Renaming;
use crate::failure::Failure;

/// A vocabulary in the making.
pub struct Draft {
    body: Arc<Skeleton>,
    primitives: Vec<Primitive>,
    behaviors: Vec<Behavior>,
    transitions: Transitions,
}

impl Draft {
    pub fn of(vocabulary: &Vocabulary) -> Self {
        Self {
            body: Arc::clone(vocabulary.body()),
            primitives: vocabulary.primitives().to_vec(),
            behaviors: vocabulary.behaviors().to_vec(),
            transitions: vocabulary.transitions().clone(),
        }
    }

    /// The primitives as they are now.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The place of a primitive that the command line names.
    pub fn place(&self, name: &str) -> Result<usize, Failure> {
        let at = self.primitives.iter().position(|p| p.name() == name);
        at.ok_or_else(|| {
            let known = self.primitives.iter().map(Primitive::name);
            Failure::usage(kineme::Error::unknown_name("primitive", name, known).to_string())
        })
    }

    /// Gives primitives other names, all at once.
    pub fn rename(&mut self, renamings: &[Renaming]) -> Result<(), Failure> {
        let mut names: Vec<String> = self.primitives.iter().map(|p| p.name().into()).collect();
        let mut done = vec![false; names.len()];
        for renaming in renamings {
            let at = self.place(&renaming.from)?;
            if std::mem::replace(&mut done[at], true) {
                let message = format!("`{}` is renamed twice", renaming.from);
                return Err(Failure::usage(message));
            }
            names[at].clone_from(&renaming.to);
        }
        for renaming in renamings {
            if names.iter().filter(|n| **n == renaming.to).count() > 1 {
                let message = format!("two primitives would be named `{}`", renaming.to);
                return Err(Failure::usage(message).hint("--merge A,B=C makes one of them"));
            }
        }
        let new_name = |old: &str| {
            let at = self.primitives.iter().position(|p| p.name() == old);
            at.map_or(old, |i| names[i].as_str()).to_owned()
        };
        for behavior in &mut self.behaviors {
            for name in &mut behavior.primitives {
                *name = new_name(name);
            }
        }
        let primitives = std::mem::take(&mut self.primitives);
        let pairs = primitives.into_iter().zip(names);
        self.primitives = pairs
            .map(|(p, name)| {
                if p.name() == name {
                    p
                } else {
                    p.renamed(&name)
                }
            })
            .collect();
        self.settle_behaviors();
        Ok(())
    }

    /// Puts `merged` in place of the first of the primitives at `places`, and drops the others: it belongs to the first
    /// one's behavior, and follows what any of them followed.
    pub fn merge(&mut self, places: &[usize], merged: Primitive) {
        let (first, name) = (places[0], merged.name().to_owned());
        let old: Vec<String> = places
            .iter()
            .map(|&i| self.primitives[i].name().to_owned())
            .collect();
        for behavior in &mut self.behaviors {
            behavior.primitives.retain(|p| !old[1..].contains(p));
            for p in &mut behavior.primitives {
                if *p == old[0] {
                    p.clone_from(&name);
                }
            }
        }
        self.primitives[first] = merged;
        self.keep(
            |i| i == first || !places.contains(&i),
            |i| {
                if places.contains(&i) { first } else { i }
            },
        );
    }

    /// Drops the primitives at `places`.
    pub fn remove(&mut self, places: &[usize]) {
        for &i in places {
            let name = self.primitives[i].name();
            for behavior in &mut self.behaviors {
                behavior.primitives.retain(|p| p != name);
            }
        }
        self.keep(|i| !places.contains(&i), |i| i);
    }

    /// Puts a primitive in place of one of the same name, or adds it with a behavior of its own.
    pub fn put(&mut self, primitive: Primitive) {
        let name = primitive.name().to_owned();
        if let Some(at) = self.primitives.iter().position(|p| p.name() == name) {
            self.primitives[at] = primitive;
            return;
        }
        self.primitives.push(primitive);
        self.behaviors.push(Behavior {
            name: name.clone(),
            primitives: vec![name],
        });
        let old = std::mem::take(&mut self.transitions);
        self.transitions = Transitions::none(old.n + 1);
        for (from, to) in (0..old.n).flat_map(|f| (0..old.n).map(move |t| (f, t))) {
            self.transitions.counts[from * (old.n + 1) + to] = old.count(from, to);
        }
        self.settle_behaviors();
    }

    /// The vocabulary that came of it.
    pub fn finished(self) -> Result<Vocabulary, Failure> {
        if self.primitives.is_empty() {
            return Err(Failure::usage("no primitive would be left"));
        }
        Ok(Vocabulary::new(
            self.body,
            self.primitives,
            self.behaviors,
            self.transitions,
        )?)
    }

    /// Keeps some primitives; successions of others count for what `becomes` makes of them, if that is kept.
    fn keep(&mut self, kept: impl Fn(usize) -> bool, becomes: impl Fn(usize) -> usize) {
        let all = self.primitives.len();
        let places: Vec<usize> = (0..all).filter(|&i| kept(i)).collect();
        let new = |old: usize| places.iter().position(|&p| p == becomes(old));
        let mut transitions = Transitions::none(places.len());
        for (from, to) in (0..all).flat_map(|f| (0..all).map(move |t| (f, t))) {
            if let (Some(f), Some(t)) = (new(from), new(to)) {
                let count = &mut transitions.counts[f * places.len() + t];
                *count = count.saturating_add(self.transitions.count(from, to));
            }
        }
        self.transitions = transitions;
        let mut index = 0;
        self.primitives.retain(|_| {
            index += 1;
            kept(index - 1)
        });
        self.settle_behaviors();
    }

    /// Empty behaviors go; one of a single primitive has its name, and others a name that no primitive took.
    fn settle_behaviors(&mut self) {
        self.behaviors.retain(|b| !b.primitives.is_empty());
        for behavior in &mut self.behaviors {
            if let [only] = behavior.primitives.as_slice() {
                behavior.name.clone_from(only);
            }
        }
        let alone: Vec<String> = self
            .behaviors
            .iter()
            .filter(|b| b.primitives.len() == 1)
            .map(|b| b.name.clone())
            .collect();
        for i in 0..self.behaviors.len() {
            while self.behaviors[i].primitives.len() > 1 && alone.contains(&self.behaviors[i].name)
            {
                self.behaviors[i].name.push('+');
            }
        }
    }
}
