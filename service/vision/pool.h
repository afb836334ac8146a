// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace windhover {

// Lends objects that are costly to make and takes them back when the last holder lets go, so that a
// stream allocates only until as many are in use as it ever needs. Take is for one thread; holders
// may let go on any thread.
template <typename T>
class Pool {
 public:
  explicit Pool(std::function<T()> make) : make_(std::move(make)) {}

  // Its contents are those of its last use.
  std::shared_ptr<T> Take() {
    for (const std::shared_ptr<T>& object : objects_) {
      if (object.use_count() != 1) continue;
      // Pairs with the release in the last holder's decrement: what it read, it has read.
      std::atomic_thread_fence(std::memory_order_acquire);
      return object;
    }
    objects_.push_back(std::make_shared<T>(make_()));
    return objects_.back();
  }

 private:
  std::function<T()> make_;
  std::vector<std::shared_ptr<T>> objects_;
};

}  // namespace windhover
