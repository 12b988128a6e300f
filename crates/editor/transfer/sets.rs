//! Sets of widgets that digits recall and, with Ctrl, store; kept in the file under `[editor]`, which runs ignore.

use super::TransferPanel;
use super::edited_function::EditedFunction;
use crate::actions::{Action, Actions};
use eframe::egui::{Button, Key, Modifiers, Ui};
use voltet_document::Edit;
use voltet_graph::ParameterValue;

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

impl TransferPanel {
    pub(super) fn set_keys(&mut self, ui: &Ui, look: &EditedFunction, actions: &mut Actions) {
        for (digit, key) in (0..).zip(DIGITS) {
            let (store, recall) = ui.input_mut(|input| {
                (input.consume_key(Modifiers::COMMAND, key), input.consume_key(Modifiers::NONE, key))
            });
            if store {
                self.store(digit, look, actions);
            } else if recall {
                self.recall(digit, look, actions);
            }
        }
    }

    /// Menu of the keys' commands.
    pub(super) fn set_menu(&mut self, ui: &mut Ui, look: &EditedFunction, actions: &mut Actions) {
        ui.menu_button("sets", |ui| {
            ui.set_min_width(210.0);
            for digit in 0..10 {
                if let Some(list) = look.sets.get(&digit) {
                    let text = format!("recall {digit}: {}", widgets(list.len()));
                    if ui.add(Button::new(text).shortcut_text(digit.to_string())).clicked() {
                        self.recall(digit, look, actions);
                        ui.close_menu();
                    }
                }
            }
            let free = (1..10).chain([0]).find(|digit| !look.sets.contains_key(digit));
            if let Some(digit) = free {
                let store = Button::new(format!("store as {digit}")).shortcut_text(format!("Ctrl+{digit}"));
                if ui.add(store).clicked() {
                    self.store(digit, look, actions);
                    ui.close_menu();
                }
            }
        })
        .response
        .on_hover_text("all widgets, kept in the file under a digit: Ctrl+0 … 9 stores, 0 … 9 recalls");
    }

    fn store(&mut self, digit: u8, look: &EditedFunction, actions: &mut Actions) {
        actions.edit(Edit::StoreSet(digit, look.list.to_vec()));
        actions.push(Action::Say(format!("{} stored as {digit}, in the file", widgets(look.list.len()))));
    }

    fn recall(&mut self, digit: u8, look: &EditedFunction, actions: &mut Actions) {
        match look.sets.get(&digit) {
            Some(list) => {
                let edit = Edit::set(&look.node.name, "widgets", ParameterValue::List(list.clone()));
                actions.edits(format!("recall the widgets {digit}"), vec![edit]);
                self.hidden.clear();
            }
            None => actions
                .push(Action::Say(format!("no widgets are stored as {digit}: Ctrl+{digit} stores these"))),
        }
    }
}

fn widgets(count: usize) -> String {
    if count == 1 { "1 widget".into() } else { format!("{count} widgets") }
}
