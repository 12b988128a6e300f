// Uses: overlap/panel. Fills: nothing. Asks for: members.
// Several widgets on one segment: the ordered integral ∫ Σ cᵢ ρᵢ e^(−T) dl. A panel ends at the breaks of every widget
// and holds a depth of at most PANEL_DEPTH. Twin of `lanes::optics::overlap::ordered`.

fn ordered(members: Members) -> vec3f {
    var walk = walk_start();
    var color = vec3f(0.0);
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let next = members_next_break(members, walk.t);
        color += ordered_panel(members, &walk, next, walk_panel(walk, next));
    }
    return color;
}
