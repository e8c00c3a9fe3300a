# cmake -DOUTPUT=... -DFILES="a.sql;b.sql" -P embed_migrations.cmake: writes the migrations as C++ source.
set(entries "")
set(expected 1)
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME_WE)
  if(NOT name MATCHES "^([0-9][0-9][0-9][0-9])_")
    message(FATAL_ERROR "${file}: a migration is named NNNN_what_changes.sql")
  endif()
  string(REGEX MATCH "[1-9][0-9]*$" version "${CMAKE_MATCH_1}")
  if(NOT version EQUAL expected)
    message(FATAL_ERROR "${file}: the next migration is number ${expected}")
  endif()
  math(EXPR expected "${expected} + 1")
  file(READ "${file}" sql)
  string(APPEND entries "    {${version}, \"${name}\", R\"sql(${sql})sql\"},\n")
endforeach()
file(WRITE "${OUTPUT}"
"// Written by embed_migrations.cmake from schema/migrations/*.sql.
#include \"schema/engine/migrations.h\"

namespace mapweld {
namespace {
constexpr Migration kMigrations[] = {
${entries}};
}  // namespace

std::span<const Migration> migrations() { return kMigrations; }

}  // namespace mapweld
")
