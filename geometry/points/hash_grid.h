/// A map from the cells of a sparse grid to values, for inner loops: open addressing with linear
/// probing, at most half full. Cells are named by keys of up to 63 bits, such as 21 bits an axis.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace skycap::geometry {

/// `Value` is cheap to copy; large ones are kept elsewhere, and their index or pointer here.
template <typename Value>
class HashGrid {
 public:
  /// With room for so many cells, after which it grows.
  explicit HashGrid(std::size_t cells = 512) {
    set_slots(std::bit_ceil(std::max<std::size_t>(2 * cells, 2)));
  }

  std::size_t size() const { return size_; }
  std::size_t memory() const { return slots_.capacity() * sizeof(Slot); }  ///< [bytes]

  /// The value of a key, or null. The pointer is valid until the next insert().
  const Value* find(std::uint64_t key) const {
    const Slot& slot = slots_[slot_of(key)];
    return slot.key == key ? &slot.value : nullptr;
  }
  Value* find(std::uint64_t key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

  struct Inserted {
    Value& value;  ///< valid until the next insert()
    bool is_new = false;
  };
  /// Gives a key this value unless it has one; returns the value that it has then.
  Inserted insert(std::uint64_t key, const Value& value = {}) {
    std::size_t slot = slot_of(key);
    if (slots_[slot].key == key) return {slots_[slot].value, false};
    if (2 * (size_ + 1) > slots_.size()) {
      grow();
      slot = slot_of(key);
    }
    slots_[slot] = {key, value};
    ++size_;
    return {slots_[slot].value, true};
  }

 private:
  static constexpr std::uint64_t no_key = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t key = no_key;
    [[no_unique_address]] Value value{};
  };

  void set_slots(std::size_t count) {  // a power of two
    slots_.assign(count, Slot{});
    shift_ = 64 - std::countr_zero(count);
  }

  /// The slot of a key, or the empty one where it would be. Fibonacci hashing: the high bits of the
  /// product depend on all bits of the key.
  std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = static_cast<std::size_t>(key * 0x9E3779B97F4A7C15U >> shift_);
    while (slots_[slot].key != key && slots_[slot].key != no_key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    std::vector<Slot> old = std::move(slots_);
    set_slots(2 * old.size());
    for (const Slot& slot : old) {
      if (slot.key != no_key) slots_[slot_of(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  int shift_ = 0;  ///< 64 - log2 of the number of slots
  std::size_t size_ = 0;
};

}  // namespace skycap::geometry
