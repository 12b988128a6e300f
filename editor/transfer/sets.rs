//! Sets of widgets that digits recall and, with Ctrl, store; kept as long as the window.

use super::look::Look;
use crate::actions::{Action, Actions};
use eframe::egui::{Key, Modifiers, Ui};
use voltet_core::graph::{Datum, Setting};
use voltet_document::Edit;

const DIGITS: [Key; 10] = [
    Key::Num0,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

#[derive(Default)]
pub(super) struct Sets([Option<Vec<Setting>>; 10]);

impl Sets {
    pub fn keys(&mut self, ui: &Ui, look: &Look, actions: &mut Actions) {
        for (digit, key) in DIGITS.into_iter().enumerate() {
            let (store, recall) = ui.input_mut(|input| {
                (input.consume_key(Modifiers::COMMAND, key), input.consume_key(Modifiers::NONE, key))
            });
            if store {
                self.0[digit] = Some(look.list.to_vec());
                actions.push(Action::Say(format!("{} widgets stored as {digit}", look.list.len())));
            } else if recall {
                match &self.0[digit] {
                    Some(list) => actions.edits(
                        format!("recall the widgets {digit}"),
                        vec![Edit::set(&look.node.name, "widgets", Datum::List(list.clone()))],
                    ),
                    None => actions
                        .push(Action::Say(format!("no widgets are stored as {digit}: Ctrl+{digit} does"))),
                }
            }
        }
    }
}
