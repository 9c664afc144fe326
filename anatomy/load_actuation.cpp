#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

/// The channels that are not muscles. Entries without a side stand alone; "paired" ones make two.
void add_actuators(const Fields& entry, std::vector<Actuator>& actuators) {
  for (const Side side : sides_of(entry)) {
    Actuator actuator;
    actuator.name = with_side(entry.text("name"), side);
    actuator.group = entry.text("group");
    actuator.minimum = entry.number("minimum");
    actuator.maximum = entry.number("maximum");
    actuator.rest = entry.number_or("rest", 0.0);
    actuator.unit = entry.text("unit");
    actuator.note = entry.text("note");
    if (!(actuator.minimum <= actuator.rest && actuator.rest <= actuator.maximum &&
          actuator.minimum < actuator.maximum))
      entry.fail("minimum <= rest <= maximum does not hold");
    actuators.push_back(actuator);
  }
}

/// Muscle channels in the order of muscles.json; each must be listed, so that the file is the full list.
void add_muscles(const Fields& root, GenericAnatomy& anatomy) {
  for (const Json& entry : root.raw("muscles")) {
    if (!entry.is_string()) root.fail("\"muscles\" is a list of names");
    const std::string name = entry.get<std::string>();
    bool found = false;
    for (const Muscle& muscle : anatomy.muscles) {
      if (with_side(name, muscle.side) != muscle.name) continue;
      anatomy.actuators.push_back(muscle_actuator(muscle));
      found = true;
    }
    if (!found) root.fail("the muscle " + name + " is not in muscles.json");
  }
}

std::vector<std::string> members_of(const Fields& entry, Side side) {
  std::vector<std::string> members;
  for (const Json& member : entry.raw("members")) {
    if (!member.is_string()) entry.fail("\"members\" is a list of names");
    members.push_back(with_side(member.get<std::string>(), side));
  }
  return members;
}

/// That `numbers` rise from 0 to 1; strictly, and without the ends, when `is_strict`.
void check_rises(const Fields& entry, const std::vector<double>& numbers, bool is_strict) {
  double last = 0.0;
  for (const double number : numbers) {
    if (is_strict ? !(number > last && number < 1.0) : !(number >= last && number <= 1.0))
      entry.fail("the numbers of a response must rise from 0 to 1");
    last = number;
  }
}

ExpressionSet set_of(const Json& document, const std::string& file) {
  const Fields root(document, file);
  ExpressionSet set;
  set.name = root.text("name");
  set.title = root.text("title");
  set.source = root.text("source");
  set.response_weights = root.numbers_or_none("response_weights");
  check_rises(root, set.response_weights, true);
  for (const Fields& entry : root.list("expressions")) {
    Expression expression;
    expression.name = entry.text("name");
    expression.corrects = entry.text_or("corrects", "");
    expression.note = entry.text_or("note", "");
    const Json& weights = entry.raw("weights");
    if (!weights.is_object()) entry.fail("\"weights\" is an object of actuator names and numbers");
    for (const auto& [name, value] : weights.items()) {
      if (!value.is_number()) entry.fail("the weight of " + name + " must be a number");
      expression.weights.emplace_back(name, value.get<double>());
    }
    expression.response = entry.numbers_or_none("response");
    if (!expression.response.empty() && expression.response.size() != set.response_weights.size())
      entry.fail("\"response\" needs one number for each of the file's response_weights");
    check_rises(entry, expression.response, false);
    if (set.find(expression.name)) entry.fail("occurs twice");
    set.expressions.push_back(expression);
  }
  return set;
}

}  // namespace

void load_actuation(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("actuators.json");
  const Fields root(document, files.place("actuators.json"));
  add_muscles(root, anatomy);
  for (const Fields& entry : root.list("others"))
    add_actuators(entry, anatomy.actuators);
  for (const Fields& entry : root.list("wholes"))
    for (const Side side : sides_of(entry))
      anatomy.wholes.push_back({with_side(entry.text("name"), side), members_of(entry, side)});
  for (const char* file : {"expressions/arkit.json", "expressions/facs.json", "expressions/visemes.json",
                           "expressions/vrm.json", "expressions/smiles.json"})
    anatomy.expression_sets.push_back(set_of(files.json(file), files.place(file)));
}

}  // namespace fascia::anatomy
