# Programs that run in Node: built and run in the build folder, so that the sources stay as they are.
find_program(NODE node REQUIRED)
find_program(NPM npm REQUIRED)

# sunder_node_folder(name folder): target <name>_node keeps ${PROJECT_BINARY_DIR}/node/<name> a copy of the folder with the packages of
# its package-lock.json installed. Install scripts do not run.
function(sunder_node_folder name folder)
  set(copy ${PROJECT_BINARY_DIR}/node/${name})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*)
  set(manifests ${folder}/package.json ${folder}/package-lock.json)
  add_custom_command(OUTPUT ${copy}/installed
    COMMAND ${CMAKE_COMMAND} -E make_directory ${copy}
    COMMAND ${CMAKE_COMMAND} -E copy ${manifests} ${copy}
    COMMAND ${CMAKE_COMMAND} -E chdir ${copy} ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${copy}/installed
    DEPENDS ${manifests} COMMENT "Installing the npm packages of ${name}" VERBATIM)
  add_custom_command(OUTPUT ${copy}/copied
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${folder} ${copy}
    COMMAND ${CMAKE_COMMAND} -E touch ${copy}/copied
    DEPENDS ${copy}/installed ${sources} COMMENT "" VERBATIM)
  add_custom_target(${name}_node ALL DEPENDS ${copy}/copied)
endfunction()

# The report page, bundled into one source of the pipeline.
function(sunder_report_page)
  sunder_node_folder(page ${PROJECT_SOURCE_DIR}/page)
  set(source ${PROJECT_BINARY_DIR}/generated/page_template.cpp)
  set(copy ${PROJECT_BINARY_DIR}/node/page)
  set(docs ${PROJECT_SOURCE_DIR}/docs/report.md)
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/generated
    COMMAND ${CMAKE_COMMAND} -E chdir ${copy} ${NODE} build.mjs ${docs} ${source}
    DEPENDS ${copy}/copied ${docs} COMMENT "Bundling the report page" VERBATIM)
  target_sources(sunder_pipeline PRIVATE ${source})
endfunction()
