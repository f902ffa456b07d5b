// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace couplet::mesh::geo_words {

/// Words of gmsh's grammar that draw or mesh, or are part of such a statement: "Point", "Transfinite", "Sqrt".
bool is_allowed(std::string_view word);
/// Words that have their meaning by position, and names for all the rest: "Loop", "Progression", "Boundary".
bool is_noun(std::string_view word);
/// Nouns before a number or a name: "Progression", "Bump".
bool takes_a_number(std::string_view word);
/// Nouns before shapes in braces: "Boundary", "Duplicata".
bool takes_shapes(std::string_view word);
/// Words of gmsh's grammar and commands by name that are let through nowhere: "Plugin", "SystemCall".
bool is_refused(std::string_view word);

/// "If", "EndFor", "Macro", ...: they stand at the beginning of a statement.
bool is_control(std::string_view word);
/// "Name", "Choices", ...: what DefineConstant says of a number.
bool is_attribute(std::string_view word);
/// Words with a bracket in which texts may stand: "Printf", "Str", "DefineConstant".
bool takes_texts(std::string_view word);
/// "Str", "StrCat", ...: what gives a text.
bool gives_text(std::string_view word);
/// "Mesh" or "Geometry", and whether the option is one that neither names nor writes a file.
bool is_option(std::string_view family, std::string_view name);
/// Kinds of fields that only compute.
bool is_field(std::string_view kind);
/// Options of fields that take a formula.
bool is_formula(std::string_view option);

/// One sentence for messages.
inline constexpr std::string_view sentence =
    "Allowed are statements for drawing and meshing: numbers, points, curves, surfaces, volumes, loops, "
    "OpenCASCADE shapes and booleans, Extrude and other transformations, Physical, Transfinite, Recombine, "
    "Periodic, sizes and Fields, For, If, Macro, DefineConstant, Include and Merge of files in the folder "
    "of the case, Printf to the terminal (docs/formats.md)";

}  // namespace couplet::mesh::geo_words
