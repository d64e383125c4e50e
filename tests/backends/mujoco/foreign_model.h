// A model that is not Crossgait's, in the same process.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "backends/mujoco/file_system.h"
#include "backends/mujoco/model.h"

namespace crossgait::mujoco {

/// @param xml  MJCF text
inline ModelPtr compile_text(const std::string& xml) {
  FileSystem files;
  files.add("model.xml", xml);
  std::array<char, 1000> error{};
  ModelPtr model(mj_loadXML("model.xml", files.get(), error.data(), static_cast<int>(error.size())));
  EXPECT_NE(model, nullptr) << error.data();
  return model;
}

/// Makes a sphere sunk into a height field, with or without a place for user data.
inline ModelPtr foreign_model(int nuserdata) {
  ModelPtr m = compile_text("<mujoco><size nuserdata='" + std::to_string(nuserdata) +
                            "'/><asset><hfield name='h' nrow='5' ncol='5' size='1 1 0.1 0.1'/></asset>"
                            "<worldbody><geom type='hfield' hfield='h'/><body pos='0.13 0.07 0.05'>"
                            "<freejoint/><geom type='sphere' size='0.1'/></body></worldbody></mujoco>");
  for (int i = 0; i < 25; ++i) m->hfield_data[i] = static_cast<float>((i * 7) % 5) / 5;
  return m;
}

inline constexpr std::size_t kNumbersPerContact = 13;

/// Lists distance, place and frame of every contact where the model begins. @param user_data  the first
/// number of it
inline std::vector<double> contacts_of(const mjModel& m, double user_data = 0) {
  const DataPtr d(mj_makeData(&m));
  if (m.nuserdata > 0) d->userdata[0] = user_data;
  mj_forward(&m, d.get());
  std::vector<double> result;
  for (int i = 0; i < d->ncon; ++i) {
    result.push_back(d->contact[i].dist);
    result.insert(result.end(), d->contact[i].pos, d->contact[i].pos + 3);
    result.insert(result.end(), d->contact[i].frame, d->contact[i].frame + 9);
  }
  return result;
}

}  // namespace crossgait::mujoco
