# Makes C of models and laws a part of a CMake project.
#
#   include(HysdelSources.cmake)
#   hysdel_plant(plant two_tanks)                     # a shipped model, or the path of a .hys file
#   hysdel_law(law two_tanks --horizon 1 ...)         # options as for: hysdel explicit
#
# Each makes a library target of that name, whose header has the same name. Needs Python with hysdel_py.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

function(hysdel_library target)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${target}.c")
  set(header "${CMAKE_CURRENT_BINARY_DIR}/${target}.h")
  add_custom_command(
    OUTPUT "${source}" "${header}"
    COMMAND "${Python3_EXECUTABLE}" -m hysdel_py ${ARGN} "${source}"
    DEPENDS ${HYSDEL_MODEL}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    COMMENT "hysdel writes ${target}.c"
    VERBATIM)
  add_library(${target} STATIC "${source}" "${header}")
  target_include_directories(${target} PUBLIC "${CMAKE_CURRENT_BINARY_DIR}")
endfunction()

# The file of a model, so that a change of it builds anew; nothing for a shipped model.
macro(hysdel_model_file model)
  set(HYSDEL_MODEL "")
  if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${model}")
    set(HYSDEL_MODEL "${CMAKE_CURRENT_SOURCE_DIR}/${model}")
  endif()
endmacro()

function(hysdel_plant target model)
  hysdel_model_file(${model})
  hysdel_library(${target} compile "${model}" ${ARGN} --output)
endfunction()

function(hysdel_law target model)
  hysdel_model_file(${model})
  hysdel_library(${target} explicit "${model}" ${ARGN} --c)
endfunction()
