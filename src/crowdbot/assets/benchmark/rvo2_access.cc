// Access to RVO2 for the benchmark of engines: people of a scene, and steps.
#include <omp.h>

#include <cstddef>

#include "RVOSimulator.h"
#include "Vector2.h"

extern "C" {

void *rvo2_new(float dt, float reach, std::size_t most, float horizon) {
  auto *simulator = new RVO::RVOSimulator();
  simulator->setTimeStep(dt);
  simulator->setAgentDefaults(reach, most, horizon, horizon, 0.25F, 2.0F);
  return simulator;
}

void rvo2_add(void *handle, std::size_t count, const double *place, const double *velocity, const double *wish,
              const double *radius, const double *top) {
  auto *simulator = static_cast<RVO::RVOSimulator *>(handle);
  const auto pair = [](const double *values, std::size_t k) {
    return RVO::Vector2(static_cast<float>(values[2 * k]), static_cast<float>(values[2 * k + 1]));
  };
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t agent = simulator->addAgent(pair(place, k));
    simulator->setAgentVelocity(agent, pair(velocity, k));
    simulator->setAgentPrefVelocity(agent, pair(wish, k));
    simulator->setAgentRadius(agent, static_cast<float>(radius[k]));
    simulator->setAgentMaxSpeed(agent, static_cast<float>(top[k]));
  }
}

void rvo2_step(void *handle, int threads) {
  omp_set_num_threads(threads);
  static_cast<RVO::RVOSimulator *>(handle)->doStep();
}

void rvo2_delete(void *handle) { delete static_cast<RVO::RVOSimulator *>(handle); }
}
