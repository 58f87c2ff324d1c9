// Drives to the goal and turns away from what the laser scanner sees, in lock step with the simulation.
//
//   g++ -std=c++17 -O2 -o drive examples/cpp/drive.cpp
//   <navigator type="process" command="./drive" sandbox="false"/>
#include <algorithm>
#include <cmath>
#include <limits>

#include "crowdbot_client.hpp"

int main(int count, char** words) {
    const std::string sensor = count > 1 ? words[1] : "scan";
    return crowdbot::serve(sensor, [](const crowdbot::Observation& o) {
        double ahead = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < o.ranges.size() && k < o.directions.size(); ++k)
            if (std::abs(o.directions[k]) < 0.5 && !std::isnan(o.ranges[k])) ahead = std::min(ahead, o.ranges[k]);
        if (ahead < 1.2) return crowdbot::Command{0.1, 0.8, 0.0};
        const double wanted = std::atan2(o.goal_y - o.y, o.goal_x - o.x);
        const double error = std::remainder(wanted - o.heading, 2.0 * M_PI);
        return crowdbot::Command{0.7 * std::max(0.0, std::cos(error)), std::clamp(1.5 * error, -1.0, 1.0), 0.0};
    });
}
