// A client of crowdbot in one header: it answers the questions of <navigator type="process" command="..."/>.
//
// The simulation asks at each control period and waits for the answer, so the program steps with it. A question and an
// answer are lines of JSON on the standard streams, see docs/how-to/process-navigator.md. C++17, nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace crowdbot {

// Text of a value in a JSON object: the first one after "key": from a place on. Names in a question are unique enough.
inline std::string value_of(const std::string& json, const std::string& key, std::size_t from = 0) {
    const std::string word = "\"" + key + "\":";
    const std::size_t place = json.find(word, from);
    if (place == std::string::npos) throw std::runtime_error("the question has no " + key);
    std::size_t begin = place + word.size(), end = begin;
    int depth = 0;
    bool text = false;
    for (; end < json.size(); ++end) {
        const char c = json[end];
        if (text) {
            if (c == '\\') ++end;
            else if (c == '"') text = false;
            continue;
        }
        if (c == '"') text = true;
        if (c == '{' || c == '[') ++depth;
        if (c == '}' || c == ']') {
            if (depth == 0) break;
            --depth;
        }
        if (c == ',' && depth == 0) break;
    }
    return json.substr(begin, end - begin);
}

// Numbers of a JSON list.
inline std::vector<double> numbers_of(const std::string& list) {
    std::vector<double> found;
    std::size_t place = list.find('[') + 1;
    while (place < list.size() && list[place] != ']') {
        std::size_t used = 0;
        found.push_back(std::stod(list.substr(place), &used));
        place += used;
        while (place < list.size() && (list[place] == ',' || list[place] == ' ')) ++place;
    }
    return found;
}

// Bytes of a base64 text.
inline std::vector<std::uint8_t> decode_base64(const std::string& text) {
    std::vector<std::uint8_t> found;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        int value = -1;
        if (c >= 'A' && c <= 'Z') value = c - 'A';
        else if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
        else if (c >= '0' && c <= '9') value = c - '0' + 52;
        else if (c == '+') value = 62;
        else if (c == '/') value = 63;
        if (value < 0) continue;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            found.push_back(static_cast<std::uint8_t>(bits >> count));
        }
    }
    return found;
}

// Numbers of an array {"dtype":"<f8","shape":[...],"data":"..."}; 8 or 4 bytes each, on little-endian computers.
inline std::vector<double> array_of(const std::string& array) {
    const std::vector<std::uint8_t> bytes = decode_base64(value_of(array, "data"));
    const bool wide = value_of(array, "dtype").find("<f8") != std::string::npos;
    if (!wide && value_of(array, "dtype").find("<f4") == std::string::npos)
        throw std::runtime_error("an array is not of floats");
    const std::size_t size = wide ? 8 : 4;
    std::vector<double> found(bytes.size() / size);
    for (std::size_t k = 0; k < found.size(); ++k) {
        float narrow = 0.0F;
        if (wide) std::memcpy(&found[k], &bytes[k * size], size);
        else {
            std::memcpy(&narrow, &bytes[k * size], size);
            found[k] = narrow;
        }
    }
    return found;
}

struct Observation {
    double time = 0.0, x = 0.0, y = 0.0, heading = 0.0, goal_x = 0.0, goal_y = 0.0;
    std::vector<double> ranges;      // of the laser scanner [m]; empty before its first scan
    std::vector<double> directions;  // of its beams in its own frame [rad]
};

struct Command {
    double forward = 0.0, turn = 0.0, left = 0.0;  // [m/s], [rad/s], [m/s]
};

// Read what the robot knows, with the scan of a sensor.
inline Observation read_observation(const std::string& question, const std::string& sensor) {
    Observation found;
    const std::string all = value_of(question, "observation");
    const std::vector<double> pose = numbers_of(value_of(all, "pose")), goal = numbers_of(value_of(all, "goal"));
    found.time = std::stod(value_of(all, "time"));
    found.x = pose.at(0), found.y = pose.at(1), found.heading = pose.at(2);
    found.goal_x = goal.at(0), found.goal_y = goal.at(1);
    const std::string readings = value_of(all, "readings");
    if (readings.find("\"" + sensor + "\":") != std::string::npos) {
        const std::string scan = value_of(readings, sensor);
        found.ranges = array_of(value_of(scan, "ranges"));
        found.directions = array_of(value_of(scan, "angles"));
    }
    return found;
}

// Answer all questions with a function from Observation to Command, until the simulation ends.
template <typename Policy>
int serve(const std::string& sensor, Policy policy) {
    std::cout << "{\"ready\":true}" << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
        try {
            if (value_of(line, "call") == "\"begin\"") {
                std::cout << "{\"memory\":\"\"}" << std::endl;
                continue;
            }
            const Command c = policy(read_observation(line, sensor));
            std::cout << "{\"twist\":[" << c.forward << "," << c.turn << "," << c.left << "],\"memory\":\"\"}" << std::endl;
        } catch (const std::exception& error) {
            std::cout << "{\"error\":\"" << error.what() << "\"}" << std::endl;
        }
    }
    return 0;
}

}  // namespace crowdbot
