#include "physics/robot_files/sdf/sdf_frames.h"

#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

[[noreturn]] void fail_as_unknown(const SdfElement& at, const std::string& name) {
  fail_at(at, "a link, joint, frame or model", fmt::format("'{}'", printable_text(name, 200)));
}

}  // namespace

void SdfFrames::add(const std::string& name, SdfFrame frame) {
  const SdfElement& element = *frame.element;
  if (!frames_.emplace(name, std::move(frame)).second)
    fail_at(element, "a name that no other link, joint, frame or model has", "a second one");
}

void SdfFrames::attach(const std::string& name, const std::string& to) { frames_.at(name).attached_to = to; }

void SdfFrames::check() {
  for (const auto& [name, frame] : frames_) {
    static_cast<void>(pose(name));
    static_cast<void>(link_of(name, *frame.element));
  }
}

const SdfFrame& SdfFrames::base(const SdfFrame& of) const {
  const auto found = frames_.find(of.base);
  if (found == frames_.end()) fail_as_unknown(*of.element, of.base);
  return found->second;
}

Pose SdfFrames::pose_below(const std::string& name, const std::string& ancestor) const {
  Pose X = Pose::Identity();
  auto at = frames_.find(name);
  for (std::size_t steps = 0; at != frames_.end() && at->first != ancestor; ++steps) {
    const SdfFrame& frame = at->second;
    if (frame.base.empty() || steps > frames_.size() || !frame.placement.empty()) break;
    X = frame.X_BF * X;
    at = frames_.find(frame.base);
  }
  const SdfElement& element = *frames_.at(ancestor).element;
  if (at == frames_.end() || at->first != ancestor)
    fail_at(element, "a placement frame in the model itself", fmt::format("'{}'", printable_text(name, 200)));
  return X;
}

Pose SdfFrames::pose(const std::string& name) {
  std::vector<std::string> way;
  std::set<std::string> seen;
  for (std::string at = name; !poses_.contains(at);) {
    const SdfFrame& frame = frames_.at(at);
    if (!seen.insert(at).second)
      fail_at(*frame.element, "a pose that is relative to something else",
              "frames relative to each other in a cycle");
    way.push_back(at);
    if (frame.base.empty()) break;
    static_cast<void>(base(frame));
    at = frame.base;
  }
  for (auto at = way.rbegin(); at != way.rend(); ++at) {
    const SdfFrame& frame = frames_.at(*at);
    Pose X = frame.base.empty() ? frame.X_BF : poses_.at(frame.base) * frame.X_BF;
    if (!frame.placement.empty()) X = X * pose_below(frame.placement, *at).inverse();
    poses_[*at] = X;
  }
  return poses_.at(name);
}

Pose SdfFrames::pose(const std::string& name, const SdfElement& at) {
  if (!frames_.contains(name)) fail_as_unknown(at, name);
  return pose(name);
}

std::string SdfFrames::link_of(const std::string& name, const SdfElement& at) {
  std::vector<SdfFrame*> way;
  std::string here = name;
  while (way.size() <= frames_.size()) {
    const auto found = frames_.find(here);
    if (found == frames_.end()) fail_as_unknown(at, here);
    if (found->second.attached_to == here) {
      for (SdfFrame* frame : way) frame->attached_to = here;  // so that the way is gone once
      return here;
    }
    way.push_back(&found->second);
    here = found->second.attached_to;
  }
  fail_at(at, "what moves with a link", "frames attached to each other in a cycle");
}

}  // namespace crossgait
