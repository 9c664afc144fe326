// Recordings: the first, and layers that are added to it.
#include <algorithm>

#include "app/workspace.h"

namespace fascia::app {

void Workspace::adopt(const ReadFile& read) {
  DocumentState next = state();
  if (!read.take) {
    next.edits = read.edits;
    return commit(std::move(next), "Load edits");
  }
  const std::string path = std::filesystem::absolute(read.file).string();
  takes_[path] = read.take;
  asked_takes_.erase(path);
  ++changes_;
  if (read.is_again) {
    if (next.take.file == path) take = read.take;
    return;
  }
  if (read.is_layer && take) {
    next.take.layers.push_back({path});
    commit(std::move(next), "Add a layer");
  } else {
    take = read.take;
    playback.is_playing = true;
    if (next.take.file != path) {
      next.take = {};
      next.take.file = path;
    }
    playback.time = next.take.begin;
    commit(std::move(next), "Load recording");
  }
  size_t known = read.take->names().size();
  if (rig) {
    const std::vector<bool> matched = read.take->matched(rig->asset->handle());
    known = static_cast<size_t>(std::count(matched.begin(), matched.end(), true));
  }
  notify("Loaded " + read.file.filename().string() + ": " + std::to_string(known) + " of " +
             std::to_string(read.take->names().size()) + " curves move this face",
         known ? Notice::Kind::info : Notice::Kind::warning);
}

void Workspace::follow_document() {
  const TakeChoice& choice = state().take;
  const auto wanted = [this](const std::string& file) -> std::shared_ptr<const Take> {
    if (const auto found = takes_.find(file); found != takes_.end()) return found->second;
    if (asked_takes_.insert(file).second) read_file(file, FileKind::take, true);
    return nullptr;
  };
  const auto before = take;
  take = choice.file.empty() ? nullptr : wanted(choice.file);
  for (const TakeLayer& layer : choice.layers)
    wanted(layer.file);
  if (take != before) playback.is_playing = false;
}

std::shared_ptr<const Take> Workspace::layer_take(size_t layer) const {
  const auto& layers = state().take.layers;
  const auto found = layer < layers.size() ? takes_.find(layers[layer].file) : takes_.end();
  return found == takes_.end() ? nullptr : found->second;
}

double Workspace::timeline_length() const {
  double length = take ? take->duration() : 0.0;
  for (size_t i = 0; i < state().take.layers.size(); ++i)
    if (const auto layer = layer_take(i)) length = std::max(length, layer->duration());
  return length;
}

double Workspace::timeline_end() const {
  const double end = state().take.end, length = timeline_length();
  return end < 0.0 ? length : std::min(end, length);
}

void Workspace::weigh_layer(int layer, double weight) {
  const double most = 2.0;
  weight = std::clamp(weight, 0.0, most);
  DocumentState next = state();
  if (layer >= static_cast<int>(next.take.layers.size())) return;
  (layer < 0 ? next.take.weight : next.take.layers[static_cast<size_t>(layer)].weight) = weight;
  commit(std::move(next), "Weight of a layer", "layer " + std::to_string(layer));
}

void Workspace::mute_layer(int layer, bool is_muted) {
  DocumentState next = state();
  if (layer >= static_cast<int>(next.take.layers.size())) return;
  (layer < 0 ? next.take.is_muted : next.take.layers[static_cast<size_t>(layer)].is_muted) = is_muted;
  commit(std::move(next), is_muted ? "Mute a layer" : "Unmute a layer");
}

void Workspace::remove_layer(int layer) {
  DocumentState next = state();
  if (layer >= static_cast<int>(next.take.layers.size())) return;
  if (layer >= 0) {
    next.take.layers.erase(next.take.layers.begin() + layer);
  } else if (next.take.layers.empty()) {
    next.take = {};
  } else {
    // The next one is the first now.
    const TakeLayer first = next.take.layers.front();
    next.take.layers.erase(next.take.layers.begin());
    next.take.file = first.file;
    next.take.weight = first.weight;
    next.take.is_muted = first.is_muted;
  }
  commit(std::move(next), "Take a layer away");
  follow_document();
  playback.time = std::clamp(playback.time, 0.0, timeline_length());
}

}  // namespace fascia::app
