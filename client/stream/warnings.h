// What a person should know of a flight: each text once.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace citystream::client {

class Warnings {
  public:
    void add(const std::string& text) {
        if (said_.insert(text).second) new_.push_back(text);
    }
    /// Those added since the last call.
    std::vector<std::string> take() { return std::exchange(new_, {}); }

  private:
    std::set<std::string> said_;
    std::vector<std::string> new_;
};

}  // namespace citystream::client
