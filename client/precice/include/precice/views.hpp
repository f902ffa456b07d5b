// SPDX-License-Identifier: Apache-2.0
// Argument types of the interface: views of texts and arrays owned by the caller.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

namespace precice {

/// View of a C string, a std::string, or anything with data() and size().
class string_view {
 public:
  string_view(const char* text) : data_(text), size_(std::char_traits<char>::length(text)) {}
  string_view(const char* text, std::size_t size) : data_(text), size_(size) {}
  template <class Text,
            class = decltype(std::declval<const Text&>().data() + std::declval<const Text&>().size())>
  string_view(const Text& text) : data_(text.data()), size_(text.size()) {}
  const char* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::string str() const { return std::string(data_, size_); }

 private:
  const char* data_;
  std::size_t size_;
};

/// View of an array, a std::vector, a std::array, or a pointer and a length.
template <class T>
class span {
 public:
  span() : data_(nullptr), size_(0) {}
  span(T* data, std::size_t size) : data_(data), size_(size) {}
  template <std::size_t n>
  span(T (&array)[n]) : data_(array), size_(n) {}
  template <class Array, class = typename std::enable_if<
                             std::is_convertible<decltype(std::declval<Array&>().data()), T*>::value>::type>
  span(Array& array) : data_(array.data()), size_(array.size()) {}
  template <class Array,
            class = typename std::enable_if<
                std::is_const<T>::value &&
                std::is_convertible<decltype(std::declval<const Array&>().data()), T*>::value>::type>
  span(const Array& array) : data_(array.data()), size_(array.size()) {}
  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) const { return data_[i]; }

 private:
  T* data_;
  std::size_t size_;
};

}  // namespace precice
