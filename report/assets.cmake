# report/page/ and D3 as bytes in a source. Included by the top CMakeLists.txt after the modules; runs itself again as a
# script when one of the files changed.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  find_file(SLIPMODE_D3 d3.min.js PATHS /usr/share/nodejs/d3/dist NO_DEFAULT_PATH)
  find_file(SLIPMODE_D3_LICENCE copyright PATHS /usr/share/doc/node-d3 NO_DEFAULT_PATH)
  mark_as_advanced(SLIPMODE_D3 SLIPMODE_D3_LICENCE)
  set(d3_files)
  if(SLIPMODE_D3 AND SLIPMODE_D3_LICENCE)
    set(d3_files ${SLIPMODE_D3} ${SLIPMODE_D3_LICENCE})
  else()
    message(STATUS "slipmode report: none (Debian's node-d3 brings what it needs)")
  endif()
  file(GLOB page_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/report/page/*)
  set(assets ${PROJECT_BINARY_DIR}/generated/report/assets.cpp)
  add_custom_command(OUTPUT ${assets}
    COMMAND ${CMAKE_COMMAND} -DPAGE=${PROJECT_SOURCE_DIR}/report/page "-DD3=${d3_files}" -DOUTPUT=${assets}
      -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${page_files} ${d3_files} ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Embedding the report's page" VERBATIM)
  target_sources(slipmode_report PRIVATE ${assets})
  set_source_files_properties(${assets} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  return()
endif()

file(WRITE ${OUTPUT} "#include \"report/internal/assets.hpp\"\n\nnamespace slipmode::report {\n")

function(embed name)
  set(hex "")
  foreach(file ${ARGN})
    file(READ ${file} part HEX)
    string(APPEND hex ${part})
  endforeach()
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  string(REGEX REPLACE "((.......){20})" "\\1\n" bytes "${bytes}")
  file(APPEND ${OUTPUT} "static const char ${name}_bytes[] = {\n${bytes}'\\0'};\n"
    "const std::string_view ${name}(${name}_bytes, sizeof ${name}_bytes - 1);\n")
endfunction()

file(GLOB scripts ${PAGE}/*.js)
list(SORT scripts)
embed(kTemplate ${PAGE}/template.html)
embed(kStyle ${PAGE}/style.css)
embed(kScript ${scripts})
list(POP_FRONT D3 d3_source)
embed(kD3 ${d3_source})
embed(kD3Licence ${D3})
file(APPEND ${OUTPUT} "}  // namespace slipmode::report\n")
