// Writes the numbers of an MSH file as text or as bytes, least significant first.
#pragma once
#include <cstdint>
#include <string>

#include "base/bytes.hpp"
#include "base/files.hpp"
#include "mesh/file_tags.hpp"

namespace almesh {

struct MshNumbers {
    FileFormat format;

    void integer(std::string& text, long long value) const {
        if (format.binary) append_bytes(text, static_cast<std::int32_t>(value), std::endian::little);
        else append_text(text, value);
    }
    void size(std::string& text, long long value) const {
        if (format.binary) append_bytes(text, static_cast<std::int64_t>(value), std::endian::little);
        else append_text(text, value);
    }
    void id(std::string& text, long long value) const {
        if (format.msh_version == 41) size(text, value);
        else integer(text, value);
    }
    void real(std::string& text, double value) const {
        if (format.binary) append_bytes(text, value, std::endian::little);
        else append_text(text, value);
    }

    // After the last number of a record.
    void end_record(std::string& text) const {
        if (!format.binary) text.back() = '\n';
    }

    std::string end_section(const std::string& name) const { return (format.binary ? "\n$End" : "$End") + name + "\n"; }

private:
    template <class Number>
    static void append_text(std::string& text, Number value) {
        append(text, value);
        text += ' ';
    }
};

}  // namespace almesh
