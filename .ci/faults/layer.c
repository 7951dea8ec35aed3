// A Vulkan layer that stands between the program and the driver and makes calls fail, for .ci/window-faults.
//
// The file named by COWBELL_FAULT says what fails: a call (swapchain, acquire, present, allocate or submit), a result
// (surface, outdated, memory or device), and perhaps the word once or a number. The call then returns this result, once
// or for as long as the file exists. With a number there is room for so many allocations, and only further ones fail.
// Without the file each call goes to the driver. The layer tells each failure on the standard error.
//
// All devices of the program are assumed to have the same driver.

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <vulkan/vulkan.h>
#include <vulkan/vk_layer.h>

static PFN_vkGetInstanceProcAddr next_of_instance;
static PFN_vkGetDeviceProcAddr next_of_device;
static PFN_vkCreateSwapchainKHR swapchain;
static PFN_vkAcquireNextImageKHR acquire;
static PFN_vkQueuePresentKHR present;
static PFN_vkAllocateMemory allocate;
static PFN_vkFreeMemory free_memory;
static PFN_vkQueueSubmit submit;

// The allocations that were not freed yet.
static atomic_int allocations;

// The result that the file names for a call, or VK_SUCCESS.
static VkResult fault(const char *call) {
  static const struct {
    const char *word;
    VkResult result;
  } results[] = {
      {"surface", VK_ERROR_SURFACE_LOST_KHR},
      {"outdated", VK_ERROR_OUT_OF_DATE_KHR},
      {"memory", VK_ERROR_OUT_OF_DEVICE_MEMORY},
      {"device", VK_ERROR_DEVICE_LOST},
  };
  const char *path = getenv("COWBELL_FAULT");
  FILE *file = path ? fopen(path, "r") : NULL;
  if (!file) return VK_SUCCESS;
  char named[16] = "", word[16] = "", times[16] = "";
  int count = fscanf(file, "%15s %15s %15s", named, word, times);
  fclose(file);
  if (count < 2 || strcmp(named, call) != 0) return VK_SUCCESS;
  for (size_t i = 0; i < sizeof results / sizeof *results; i++) {
    if (strcmp(word, results[i].word) != 0) continue;
    if (strcmp(times, "once") == 0) unlink(path);
    else if (allocations < atoi(times)) return VK_SUCCESS;
    fprintf(stderr, "layer: %s fails: %s\n", call, word);
    return results[i].result;
  }
  return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL swapchain_or_fail(VkDevice device, const VkSwapchainCreateInfoKHR *info,
                                                        const VkAllocationCallbacks *callbacks,
                                                        VkSwapchainKHR *chain) {
  VkResult failed = fault("swapchain");
  return failed ? failed : swapchain(device, info, callbacks, chain);
}

static VKAPI_ATTR VkResult VKAPI_CALL acquire_or_fail(VkDevice device, VkSwapchainKHR chain, uint64_t timeout,
                                                      VkSemaphore semaphore, VkFence fence, uint32_t *index) {
  VkResult failed = fault("acquire");
  return failed ? failed : acquire(device, chain, timeout, semaphore, fence, index);
}

// The driver presents in any case, because a failed call waits for its semaphores too.
static VKAPI_ATTR VkResult VKAPI_CALL present_or_fail(VkQueue queue, const VkPresentInfoKHR *info) {
  VkResult presented = present(queue, info);
  VkResult failed = fault("present");
  return failed ? failed : presented;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_or_fail(VkDevice device, const VkMemoryAllocateInfo *info,
                                                       const VkAllocationCallbacks *callbacks,
                                                       VkDeviceMemory *memory) {
  VkResult result = fault("allocate");
  if (result == VK_SUCCESS) result = allocate(device, info, callbacks, memory);
  if (result == VK_SUCCESS) allocations++;
  return result;
}

static VKAPI_ATTR void VKAPI_CALL free_and_count(VkDevice device, VkDeviceMemory memory,
                                                 const VkAllocationCallbacks *callbacks) {
  if (memory != VK_NULL_HANDLE) allocations--;
  free_memory(device, memory, callbacks);
}

static VKAPI_ATTR VkResult VKAPI_CALL submit_or_fail(VkQueue queue, uint32_t count, const VkSubmitInfo *infos,
                                                     VkFence fence) {
  VkResult failed = fault("submit");
  return failed ? failed : submit(queue, count, infos, fence);
}

// The loader gives each layer a chain of links, and its own link is the first.
static VkLayerInstanceCreateInfo *instance_link(const void *next) {
  VkLayerInstanceCreateInfo *info = (VkLayerInstanceCreateInfo *)next;
  while (info && !(info->sType == VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO &&
                   info->function == VK_LAYER_LINK_INFO))
    info = (VkLayerInstanceCreateInfo *)info->pNext;
  return info;
}

static VkLayerDeviceCreateInfo *device_link(const void *next) {
  VkLayerDeviceCreateInfo *info = (VkLayerDeviceCreateInfo *)next;
  while (info && !(info->sType == VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO &&
                   info->function == VK_LAYER_LINK_INFO))
    info = (VkLayerDeviceCreateInfo *)info->pNext;
  return info;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo *info,
                                                      const VkAllocationCallbacks *callbacks, VkInstance *instance) {
  VkLayerInstanceCreateInfo *link = instance_link(info->pNext);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  next_of_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  PFN_vkCreateInstance create = (PFN_vkCreateInstance)next_of_instance(NULL, "vkCreateInstance");
  return create ? create(info, callbacks, instance) : VK_ERROR_INITIALIZATION_FAILED;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice adapter, const VkDeviceCreateInfo *info,
                                                    const VkAllocationCallbacks *callbacks, VkDevice *device) {
  VkLayerDeviceCreateInfo *link = device_link(info->pNext);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  PFN_vkGetInstanceProcAddr of_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  next_of_device = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  PFN_vkCreateDevice create = (PFN_vkCreateDevice)of_instance(NULL, "vkCreateDevice");
  VkResult created = create ? create(adapter, info, callbacks, device) : VK_ERROR_INITIALIZATION_FAILED;
  if (created != VK_SUCCESS) return created;
  swapchain = (PFN_vkCreateSwapchainKHR)next_of_device(*device, "vkCreateSwapchainKHR");
  acquire = (PFN_vkAcquireNextImageKHR)next_of_device(*device, "vkAcquireNextImageKHR");
  present = (PFN_vkQueuePresentKHR)next_of_device(*device, "vkQueuePresentKHR");
  allocate = (PFN_vkAllocateMemory)next_of_device(*device, "vkAllocateMemory");
  free_memory = (PFN_vkFreeMemory)next_of_device(*device, "vkFreeMemory");
  submit = (PFN_vkQueueSubmit)next_of_device(*device, "vkQueueSubmit");
  return VK_SUCCESS;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL of_device(VkDevice device, const char *name);
static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL of_instance(VkInstance instance, const char *name);

static PFN_vkVoidFunction own(const char *name) {
  static const struct {
    const char *name;
    PFN_vkVoidFunction function;
  } functions[] = {
      {"vkGetInstanceProcAddr", (PFN_vkVoidFunction)of_instance},
      {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)of_device},
      {"vkCreateInstance", (PFN_vkVoidFunction)create_instance},
      {"vkCreateDevice", (PFN_vkVoidFunction)create_device},
      {"vkCreateSwapchainKHR", (PFN_vkVoidFunction)swapchain_or_fail},
      {"vkAcquireNextImageKHR", (PFN_vkVoidFunction)acquire_or_fail},
      {"vkQueuePresentKHR", (PFN_vkVoidFunction)present_or_fail},
      {"vkAllocateMemory", (PFN_vkVoidFunction)allocate_or_fail},
      {"vkFreeMemory", (PFN_vkVoidFunction)free_and_count},
      {"vkQueueSubmit", (PFN_vkVoidFunction)submit_or_fail},
  };
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
    if (strcmp(name, functions[i].name) == 0) return functions[i].function;
  return NULL;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL of_device(VkDevice device, const char *name) {
  PFN_vkVoidFunction function = own(name);
  return function ? function : next_of_device(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL of_instance(VkInstance instance, const char *name) {
  PFN_vkVoidFunction function = own(name);
  return function ? function : next_of_instance(instance, name);
}

VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *offer) {
  if (offer->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  offer->loaderLayerInterfaceVersion = 2;
  offer->pfnGetInstanceProcAddr = of_instance;
  offer->pfnGetDeviceProcAddr = of_device;
  offer->pfnGetPhysicalDeviceProcAddr = NULL;
  return VK_SUCCESS;
}
