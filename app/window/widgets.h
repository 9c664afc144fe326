#pragma once

#include <imgui.h>

#include <map>
#include <string>

/// The few widgets that the panels are made of. Each puts where it stands under its name, so that a script
/// finds it as a hand would.
namespace fascia::app::ui {

/// Where the items of the last whole frame were, in pixels, by name.
const std::map<std::string, ImVec4>& items();
/// Begins to note a new frame's.
void begin_items();
/// Notes the last item of Dear ImGui under a name.
void note(const std::string& name);

enum class Emphasis { plain, strong, quiet };

/// A button of `width` pixels; 0: as wide as its name. A name may end with ##something that is not shown.
bool button(const std::string& name, Emphasis emphasis = Emphasis::plain, float width = 0.0F);

/// A rounded switch that is filled while it is on.
bool chip(const std::string& name, bool& is_on);

/// A row of buttons of which one is pressed in; returns whether another was chosen. Scripts know them as KIND
/// NAME.
bool choice(const char* kind, const char* const* names, int count, int& chosen, float width);

/// A checkbox.
bool check(const std::string& name, bool& is_on);

/// A slider that fills from `rest`; `tint` colours the filling, `tag` stands before it (L, R, or nothing). A
/// double click brings it back to rest, a click with Ctrl lets the value be typed. `has_ended` when the hand
/// lets go.
struct SliderLook {
  float minimum = 0.0F, maximum = 1.0F, rest = 0.0F;
  ImVec4 tint;
  const char* tag = "";
  const char* format = "%.2f";
};
bool slider(const std::string& name, float& value, const SliderLook& look, float width, bool& has_ended);

/// A heading within a panel, with space before it.
void heading(const char* text);
/// Text in the faint colour, wrapped.
void hint(const std::string& text);
/// A star that is filled for favourites.
bool star(const std::string& name, bool is_on);
/// A field to search with; `width` pixels.
bool search(const char* hint_text, std::string& text, float width);
/// A thin bar, filled by `share`.
void progress_bar(float share, float width, float height);
/// Text cut off with dots where it is longer than `width`.
std::string shortened(const std::string& text, float width);
void tooltip(const std::string& text);

}  // namespace fascia::app::ui
